"""Pictures in sixel (DEC STD 070, chapter 11; https://vt100.net/docs/vt3xx-gp/chapter14.html).

A character has six pixels of one colour, one above the other. The colours are a cube that is the same for all pictures.
Bands are put together by operations on whole rows of bytes, because a loop over pixels takes ten times as long.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from operator import add

from groundstation.pictures.picture import Picture

BAND = 6
"""Rows of a band."""
FINE, COARSE = 6, 4
"""Levels of each channel: 216 or 64 colours; terminals have 256 at least, and few have more."""
_NOTHING = "?"
"""The character of no pixel; its code is 63."""
_REPEATED = re.compile(r"(.)\1{3,}")


def encode_sixel(picture: Picture, levels: int = FINE) -> str:
    """Return what draws a picture at the cursor; pixels of the terminal are those of the picture."""
    indices = _indices(picture, levels)
    colours = sorted(set(indices))
    size, steps = picture.width, levels - 1
    parts = [f'\x1bP0;1;0q"1;1;{size};{picture.height}']
    parts += (f"#{number};2;{_percents(number, levels, steps)}" for number in colours)
    for top in range(0, picture.height, BAND):
        rows = [indices[at * size : (at + 1) * size] for at in range(top, min(top + BAND, picture.height))]
        parts.append("$".join(_lines(rows)))
        parts.append("-")
    return "".join([*parts[:-1], "\x1b\\"])


def _percents(number: int, levels: int, steps: int) -> str:
    return ";".join(str(100 * (number // levels**place % levels) // steps) for place in (2, 1, 0))


def _indices(picture: Picture, levels: int) -> bytes:
    """Return the number of the colour of each pixel."""
    red, green, blue = (picture.rgb[channel::3].translate(_scale(levels, 2 - channel)) for channel in range(3))
    return bytes(map(add, map(add, red, green), blue))


@lru_cache(8)
def _scale(levels: int, place: int) -> bytes:
    """Return a table: value of a channel -> its part of the number of the colour."""
    steps = levels - 1
    return bytes(round(value * steps / 255) * levels**place for value in range(256))


def _lines(rows: list[bytes]) -> Iterator[str]:
    """Yield the characters of each colour of a band."""
    width = len(rows[0])
    used = [set(row) for row in rows]
    for colour in sorted(set().union(*used)):
        bits = 0
        for number, row in enumerate(rows):
            if colour in used[number]:
                bits |= int.from_bytes(row.translate(_bit_table(colour, number)), "big")
        text = bits.to_bytes(width, "big").translate(_CHARACTERS).decode().rstrip(_NOTHING)
        yield f"#{colour}{_REPEATED.sub(_count, text)}"


def _count(run: re.Match[str]) -> str:
    return f"!{len(run[0])}{run[1]}"


_CHARACTERS = bytes(min(63 + value, 255) for value in range(256))


@lru_cache(FINE**3 * BAND)
def _bit_table(colour: int, number: int) -> bytes:
    """Return a table: number of a colour -> the bit of a row if it is this colour."""
    table = bytearray(256)
    table[colour] = 1 << number
    return bytes(table)
