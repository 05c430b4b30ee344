"""Saved parameters as text: one `NAME value` a line, and a checksum at the end."""

from __future__ import annotations

from collections.abc import Mapping

from vehicle.storage.checksummed_file import CorruptFileError, add_checksum, strip_checksum

HEAD = "# Parameters set by ground stations. Written by the vehicle; a change by hand damages the file.\n"


def encode(values: Mapping[str, float]) -> bytes:
    """Return the file that holds `values`."""
    return add_checksum((HEAD + "".join(f"{name} {value!r}\n" for name, value in sorted(values.items()))).encode())


def decode(data: bytes) -> dict[str, float]:
    """Return the values of a file. Raises CorruptFileError."""
    try:
        lines = [line.split() for line in strip_checksum(data).decode().splitlines() if not line.startswith("#")]
        return {name: float(value) for name, value in lines}
    except ValueError as error:
        raise CorruptFileError(str(error)) from error
