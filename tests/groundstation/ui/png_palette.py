"""Makes PNG pictures of terminals small: true colour with many blends becomes a palette."""

from __future__ import annotations

import struct
import zlib
from collections import Counter
from collections.abc import Iterator

SIGNATURE = b"\x89PNG\r\n\x1a\n"
COLOURS = 256
"""Of the palette: the colours of a theme, and blends at the edges of letters."""
BUCKET = 4
"""Bits of a channel in which colours of one bucket may differ: the palette has the most frequent one of each."""
Colour = tuple[int, int, int]


def to_palette(png: bytes) -> bytes:
    """Return a picture of 8 bits a channel with a palette; a colour that is not in it becomes the nearest."""
    chunks = list(read_chunks(png))
    width, height, depth, kind = struct.unpack(">IIBB", chunks[0][1][:10])
    if depth != 8 or kind not in (2, 6):
        return png
    data = zlib.decompress(b"".join(body for name, body in chunks if name == b"IDAT"))
    rows = list(_rows(data, width, height, 4 if kind == 6 else 3))
    palette = choose_palette(Counter(pixel for row in rows for pixel in row))
    found = {colour: index for index, colour in enumerate(palette)}
    lines = bytearray()
    for row in rows:
        lines.append(0)
        lines += bytes(_index(pixel, palette, found) for pixel in row)
    head = struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)
    parts = [(b"IHDR", head), (b"PLTE", bytes(part for each in palette for part in each))]
    return SIGNATURE + b"".join(_chunk(*each) for each in (*parts, (b"IDAT", zlib.compress(lines, 9)), (b"IEND", b"")))


def choose_palette(counts: Counter[Colour], size: int = COLOURS) -> list[Colour]:
    """Return at most `size` colours: the most frequent of each bucket, then the most frequent of all that are left."""
    first: dict[tuple[int, ...], Colour] = {}
    for colour, _ in counts.most_common():
        first.setdefault(tuple(part >> BUCKET for part in colour), colour)
    return list(dict.fromkeys((*first.values(), *(colour for colour, _ in counts.most_common()))))[:size]


def _index(pixel: Colour, palette: list[Colour], found: dict[Colour, int]) -> int:
    if pixel not in found:
        distances = [sum((a - b) ** 2 for a, b in zip(pixel, each, strict=True)) for each in palette]
        found[pixel] = distances.index(min(distances))
    return found[pixel]


def read_chunks(png: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Yield name and content of each chunk."""
    at = len(SIGNATURE)
    while at < len(png):
        size, name = struct.unpack_from(">I4s", png, at)
        yield name, png[at + 8 : at + 8 + size]
        at += size + 12


def _chunk(name: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))


def _rows(data: bytes, width: int, height: int, step: int) -> Iterator[list[Colour]]:
    """Yield the colours of each row; undoes the filters of PNG (https://www.w3.org/TR/png/#9Filters)."""
    size, above = width * step, bytearray(width * step)
    for at in range(0, height * (size + 1), size + 1):
        row = _unfilter(data[at], bytearray(data[at + 1 : at + 1 + size]), above, step)
        above = row
        yield list(zip(row[0::step], row[1::step], row[2::step], strict=True))


def _unfilter(kind: int, row: bytearray, above: bytearray, step: int) -> bytearray:
    for at in range(len(row)) if kind else ():
        left = row[at - step] if at >= step else 0
        corner = above[at - step] if at >= step else 0
        row[at] = (row[at] + _predict(kind, left, above[at], corner)) & 0xFF
    return row


def _predict(kind: int, left: int, above: int, corner: int) -> int:
    if kind == 4:
        guess = left + above - corner
        return min((left, above, corner), key=lambda each: abs(guess - each))
    return (left, above, (left + above) // 2)[kind - 1]
