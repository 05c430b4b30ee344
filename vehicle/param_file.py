"""Saved parameters as text: `NAME value` a line, and a checksum at the end; reading and writing files is the store's.

The checksum is over all that stands before it, so half a file, and a file with a flipped bit, are not taken for whole.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping

HEAD = "# What ground stations have set. Written by the vehicle; changed by hand it counts as damaged.\n"
SUM = "# sum "


class DamagedError(ValueError):
    """These are not parameters as they were written."""


def dump(values: Mapping[str, float]) -> bytes:
    """The file."""
    body = HEAD + "".join(f"{name} {value!r}\n" for name, value in sorted(values.items()))
    return f"{body}{SUM}{_sum(body.encode())}\n".encode()


def parsed(data: bytes) -> dict[str, float]:
    """The values of a file. Raises DamagedError."""
    body, mark, rest = data.rpartition(SUM.encode())
    if not mark or rest != f"{_sum(body)}\n".encode():
        raise DamagedError("its checksum is wrong")
    try:
        lines = [line.split() for line in body.decode().splitlines() if not line.startswith("#")]
        return {name: float(value) for name, value in lines}
    except ValueError as error:
        raise DamagedError(str(error)) from error


def _sum(data: bytes) -> str:
    return f"{zlib.crc32(data):08x}"
