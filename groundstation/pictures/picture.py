"""Picture: 8 bits of red, green and blue for each pixel. Scaled, greyed and made coarser by it."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from operator import add, itemgetter

import msgspec

_RED, _GREEN, _BLUE = (bytes(value * share >> 8 for value in range(256)) for share in (77, 150, 29))
"""The part of each channel in the brightness (ITU-R BT.601), of 256."""

_PALE = bytes(40 + value * 3 // 5 for value in range(256))
"""Contrast of a greyed picture: it must not look like a black and white camera."""


class Picture(msgspec.Struct, frozen=True):
    """A picture, row by row from the top."""

    width: int
    height: int
    rgb: bytes

    def row(self, number: int) -> bytes:
        """Return the pixels of a row, from 0."""
        return self.rows(number, number + 1)

    def rows(self, first: int, end: int) -> bytes:
        """Return the pixels of some rows, without those of row `end`."""
        size = 3 * self.width
        return self.rgb[first * size : end * size]

    def brightness(self) -> bytes:
        """Return one byte for each pixel, 0 to 255."""
        red, green, blue = (self.rgb[channel::3] for channel in range(3))
        return bytes(map(add, map(add, red.translate(_RED), green.translate(_GREEN)), blue.translate(_BLUE)))

    def greyed(self) -> Picture:
        """Return the picture without colours and with little contrast, which says that it is old."""
        grey, rgb = self.brightness().translate(_PALE), bytearray(len(self.rgb))
        rgb[0::3] = rgb[1::3] = rgb[2::3] = grey
        return Picture(self.width, self.height, bytes(rgb))

    def resized(self, width: int, height: int) -> Picture:
        """Return the picture in another size: each pixel is the nearest one."""
        if (width, height) == (self.width, self.height):
            return self
        pick = _pick(self.width, width)
        rows: dict[int, bytes] = {}
        for y in range(height):
            source = y * self.height // height
            if source not in rows:
                rows[source] = bytes(pick(self.row(source)))
        return Picture(width, height, b"".join(rows[y * self.height // height] for y in range(height)))

    def coarser(self, factor: int) -> Picture:
        """Return the picture with 1/factor of the pixels in each direction, and one at least."""
        return self.resized(max(1, self.width // factor), max(1, self.height // factor))


@lru_cache(8)
def _pick(width: int, wanted: int) -> Callable[[bytes], tuple[int, ...]]:
    """Return what picks the bytes of `wanted` pixels from a row of `width`."""
    return itemgetter(*(3 * (x * width // wanted) + channel for x in range(wanted) for channel in range(3)))
