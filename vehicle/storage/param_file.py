"""Saved parameters as text: `NAME value` a line, and a checksum at the end; files are the store's matter."""

from __future__ import annotations

from collections.abc import Mapping

from vehicle.storage.checksummed_file import CorruptFileError, add_checksum, strip_checksum

HEAD = "# What ground stations have set. Written by the vehicle; changed by hand it counts as damaged.\n"


def encode(values: Mapping[str, float]) -> bytes:
    """The file."""
    return add_checksum((HEAD + "".join(f"{name} {value!r}\n" for name, value in sorted(values.items()))).encode())


def decode(data: bytes) -> dict[str, float]:
    """The values of a file. Raises DamagedError."""
    try:
        lines = [line.split() for line in strip_checksum(data).decode().splitlines() if not line.startswith("#")]
        return {name: float(value) for name, value in lines}
    except ValueError as error:
        raise CorruptFileError(str(error)) from error
