"""A text file with a checksum as its last line: half of one, and one with a flipped bit, are not taken for whole."""

from __future__ import annotations

import zlib

SUM = b"# sum "


class CorruptFileError(ValueError):
    """This is not what was written."""


def add_checksum(body: bytes) -> bytes:
    """`body`, whole lines, and its checksum."""
    return body + SUM + _sum(body) + b"\n"


def strip_checksum(data: bytes) -> bytes:
    """What was sealed. Raises DamagedError."""
    body, mark, rest = data.rpartition(SUM)
    if not mark or rest != _sum(body) + b"\n":
        raise CorruptFileError("its checksum is wrong")
    return body


def _sum(body: bytes) -> bytes:
    return f"{zlib.crc32(body):08x}".encode()
