"""PNG: a picture as a file (https://www.w3.org/TR/png/), without a library."""

from __future__ import annotations

import struct
import zlib

from groundstation.pictures.picture import Picture

SIGNATURE = b"\x89PNG\r\n\x1a\n"
_DEPTH, _TRUE_COLOUR = 8, 2


def encode_png(picture: Picture) -> bytes:
    """Return a PNG file with 8 bits a channel."""
    head = struct.pack(">IIBBBBB", picture.width, picture.height, _DEPTH, _TRUE_COLOUR, 0, 0, 0)
    lines = b"".join(b"\0" + picture.row(y) for y in range(picture.height))  # 0: no filter
    parts = ((b"IHDR", head), (b"IDAT", zlib.compress(lines)), (b"IEND", b""))
    return SIGNATURE + b"".join(_chunk(name, body) for name, body in parts)


def _chunk(name: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
