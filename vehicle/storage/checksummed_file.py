"""A text file with a checksum in its last line, which detects truncated and corrupted files."""

from __future__ import annotations

import zlib

SUM = b"# sum "
"""Start of the last line; CRC-32 in hexadecimal follows."""


class CorruptFileError(ValueError):
    """The content is not what was written."""


def add_checksum(body: bytes) -> bytes:
    """Return `body`, which consists of whole lines, with its checksum line."""
    return body + SUM + _checksum(body) + b"\n"


def strip_checksum(data: bytes) -> bytes:
    """Return the body of a file. Raises CorruptFileError."""
    body, mark, rest = data.rpartition(SUM)
    if not mark or rest != _checksum(body) + b"\n":
        raise CorruptFileError("its checksum is wrong")
    return body


def _checksum(body: bytes) -> bytes:
    return f"{zlib.crc32(body):08x}".encode()
