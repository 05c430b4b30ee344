"""Saved parameters as text: `NAME value` a line, and a checksum at the end; files are the store's matter."""

from __future__ import annotations

from collections.abc import Mapping

from vehicle.storage.checksummed_file import DamagedError, sealed, unsealed

HEAD = "# What ground stations have set. Written by the vehicle; changed by hand it counts as damaged.\n"


def dump(values: Mapping[str, float]) -> bytes:
    """The file."""
    return sealed((HEAD + "".join(f"{name} {value!r}\n" for name, value in sorted(values.items()))).encode())


def parsed(data: bytes) -> dict[str, float]:
    """The values of a file. Raises DamagedError."""
    try:
        lines = [line.split() for line in unsealed(data).decode().splitlines() if not line.startswith("#")]
        return {name: float(value) for name, value in lines}
    except ValueError as error:
        raise DamagedError(str(error)) from error
