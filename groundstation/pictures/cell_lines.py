"""Half blocks as whole lines of escape sequences: each line stands for itself, wherever a screen puts it.

Lines of the Drive screen are drawn by its compositor, which knows what lies over them. So they are text that is ready.
It is made by few steps for each cell: 160 x 45 cells at 10 pictures a second are 72,000 cells a second.
"""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from groundstation.pictures.cells import CACHED_COLOURS, HALF_BLOCK, RESET, Ink, colour_16, colour_256, true_colour
from groundstation.pictures.picture import Picture
from groundstation.pictures.protocol import Protocol


class CellLevel(msgspec.Struct, frozen=True):
    """How coarse half blocks are drawn."""

    square: int
    """Columns of a square of one colour."""
    bits: int
    """Bits that are kept of each channel: neighbours become equal, and the line shorter."""


LEVELS = (CellLevel(1, 5), CellLevel(1, 3), CellLevel(2, 3), CellLevel(4, 3), CellLevel(8, 2))
"""From fine to coarse."""
INKS: dict[Protocol, Ink] = {
    Protocol.BLOCKS: true_colour,
    Protocol.BLOCKS_256: colour_256,
    Protocol.BLOCKS_16: colour_16,
}
"""Ways to draw half blocks -> the colours of each."""


def simplify(picture: Picture, columns: int, rows: int, level: int) -> Picture:
    """Return the picture in the pixels of an area of cells, with the squares and colours of a level."""
    chosen = LEVELS[level]
    fitted = picture.resized(columns, 2 * rows)
    if chosen.square > 1:
        fitted = fitted.coarser(chosen.square).resized(columns, 2 * rows)
    return Picture(columns, 2 * rows, fitted.rgb.translate(_TABLES[chosen.bits]))


def _table(bits: int) -> bytes:
    most = (1 << bits) - 1
    return bytes((value >> 8 - bits) * 255 // most for value in range(256))


_TABLES = {bits: _table(bits) for bits in {level.bits for level in LEVELS}}


class CellLines:
    """Draws pictures that have one pixel a column and two a row."""

    def __init__(self, ink: Ink) -> None:
        self._texts, self._grounds = _Codes(ink, ground=False), _Codes(ink, ground=True)
        self._drawn: dict[bytes, str] = {}
        """Pixels of two rows of the last picture -> their line: what stands still is not drawn again."""

    def draw(self, picture: Picture) -> list[str]:
        """Return one line for two rows of pixels."""
        self._texts.tidy()
        self._grounds.tidy()
        before, self._drawn = self._drawn, {}
        lines = []
        for y in range(0, picture.height - 1, 2):
            rows = picture.rows(y, y + 2)
            line = self._drawn[rows] = before.get(rows) or self._draw_rows(rows, picture.width)
            lines.append(line)
        return lines

    def _draw_rows(self, rows: bytes, width: int) -> str:
        values = pixel_numbers(rows)
        return self._draw_line(values[:width], values[width:])

    def _draw_line(self, upper: Sequence[int], lower: Sequence[int]) -> str:
        texts, grounds = self._texts, self._grounds
        parts = list[str]()
        add = parts.append
        text = ground = -1
        for above, below in zip(upper, lower, strict=True):
            if below != ground:
                add(grounds[below])
                ground = below
            if above == below:
                add(" ")
                continue
            if above != text:
                add(texts[above])
                text = above
            add(HALF_BLOCK)
        add(RESET)
        return "".join(parts)


def pixel_numbers(pixels: bytes) -> list[int]:
    """Return each pixel as a number, which is compared and looked up sooner than three bytes."""
    padded = bytearray(len(pixels) // 3 * 4)
    for channel in range(3):
        padded[channel::4] = pixels[channel::3]
    return memoryview(padded).cast("I").tolist()


class _Codes(dict[int, str]):
    """Number of a pixel -> the sequence that sets its colour."""

    def __init__(self, ink: Ink, *, ground: bool) -> None:
        super().__init__()
        self._ink, self._ground = ink, ground

    def __missing__(self, number: int) -> str:
        code = self[number] = f"\x1b[{self._ink(_as_bytes(number)[:3], self._ground)}m"
        return code

    def tidy(self) -> None:
        """Forget the colours, if there are very many."""
        if len(self) > CACHED_COLOURS:
            self.clear()


def _as_bytes(number: int) -> bytes:
    """Return the four bytes of a pixel in the order of this machine, as pixel_numbers has read them."""
    padded = bytearray(4)
    memoryview(padded).cast("I")[0] = number
    return bytes(padded)
