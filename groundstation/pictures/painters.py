"""Painters: what draws pictures into an area of cells, one for each protocol, finer or coarser."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol as Interface

import msgspec

from groundstation.pictures.cells import AsciiEncoder, CellEncoder, colour_16, colour_256, true_colour
from groundstation.pictures.kitty import KittyEncoder
from groundstation.pictures.picture import Picture
from groundstation.pictures.protocol import DEFAULT_CELL, Protocol
from groundstation.pictures.sixel import BAND, COARSE, FINE, encode_sixel

MAX_CELLS = (240, 140)
"""Pixels that half blocks show at most."""
MAX_PIXELS = (640, 360)
"""Pixels that kitty graphics have at most; the terminal scales them to the area."""
MAX_SIXELS = (400, 240)
"""Pixels of sixel at most; it is smaller than a large area, because each pixel costs time in Python."""
MAX_LEVEL = 3
"""The coarsest level; 0 is fine."""
BEGIN_UPDATE, END_UPDATE = "\x1b[?2026h", "\x1b[?2026l"
"""A terminal that knows synchronized output shows what is between them at once."""


class Area(msgspec.Struct, frozen=True):
    """A part of the terminal."""

    columns: int
    rows: int
    row: int = 1
    """Of its first cell, from 1."""
    column: int = 1
    cell: tuple[int, int] = DEFAULT_CELL
    """Width and height of a cell in pixels."""


class Painter(Interface):
    """Draws pictures."""

    def fit(self, area: Area) -> tuple[int, int]:
        """Return width and height of the pictures that the area shows pixel by pixel; both are even."""

    def paint(self, picture: Picture, area: Area, level: int) -> str:
        """Return what draws a picture of any size; `level`: 0 is fine, MAX_LEVEL the coarsest."""

    def clear(self) -> str:
        """Return what removes pictures that clearing the cells leaves; the next picture is drawn whole."""


class CellPainter:
    """Half blocks or characters."""

    def __init__(self, encoder: CellEncoder | AsciiEncoder) -> None:
        self._encoder = encoder

    def fit(self, area: Area) -> tuple[int, int]:
        """Return one pixel a column and two a row."""
        return min(area.columns, MAX_CELLS[0]) & ~1 or 2, min(2 * area.rows, MAX_CELLS[1])

    def paint(self, picture: Picture, area: Area, level: int) -> str:
        """Return the cells that have changed; a coarser one has larger squares of one colour."""
        width, height = self.fit(area)
        fitted = picture.resized(width, height)
        if level:
            fitted = fitted.coarser(2 * level).resized(width, height)
        row = area.row + (area.rows - height // 2) // 2
        column = area.column + (area.columns - width) // 2
        return self._encoder.encode(fitted, row, column)

    def clear(self) -> str:
        """Return nothing: cells are cleared with the terminal."""
        self._encoder.forget()
        return ""


class KittyPainter:
    """Kitty graphics."""

    def __init__(self) -> None:
        self._encoder = KittyEncoder()

    def fit(self, area: Area) -> tuple[int, int]:
        """Return the pixels of the area, in its proportions within MAX_PIXELS."""
        return _bounded(area, MAX_PIXELS)

    def paint(self, picture: Picture, area: Area, level: int) -> str:
        """Return the picture, with fewer pixels if it is coarse: the terminal makes them larger."""
        drawn = self._encoder.encode(picture.coarser(level + 1), area.columns, area.rows)
        return f"\x1b[{area.row};{area.column}H{drawn}"

    def clear(self) -> str:
        """Return what deletes the pictures."""
        return self._encoder.clear()


class SixelPainter:
    """Sixel."""

    def fit(self, area: Area) -> tuple[int, int]:
        """Return the pixels of the area within MAX_SIXELS, in whole bands: a part of one may scroll the terminal."""
        width, height = _bounded(area, MAX_SIXELS)
        return width, height // BAND * BAND or BAND

    def paint(self, picture: Picture, area: Area, level: int) -> str:
        """Return the picture in the middle of the area; a coarser one has fewer colours and larger squares."""
        width, height = self.fit(area)
        fitted = picture.resized(width, height)
        if level > 1:
            fitted = fitted.coarser(2 * level).resized(width, height)
        row = area.row + max(0, area.rows * area.cell[1] - height) // area.cell[1] // 2
        column = area.column + max(0, area.columns * area.cell[0] - width) // area.cell[0] // 2
        return f"\x1b[{row};{column}H{encode_sixel(fitted, COARSE if level else FINE)}"

    def clear(self) -> str:
        """Return nothing: terminals remove sixels with the cells."""
        return ""


PAINTERS: dict[Protocol, Callable[[], Painter]] = {
    Protocol.KITTY: KittyPainter,
    Protocol.SIXEL: SixelPainter,
    Protocol.BLOCKS: lambda: CellPainter(CellEncoder(true_colour)),
    Protocol.BLOCKS_256: lambda: CellPainter(CellEncoder(colour_256)),
    Protocol.BLOCKS_16: lambda: CellPainter(CellEncoder(colour_16)),
    Protocol.ASCII: lambda: CellPainter(AsciiEncoder()),
}
"""Protocol -> what makes its painter."""


def _bounded(area: Area, most: tuple[int, int]) -> tuple[int, int]:
    """Return the pixels of the area, made smaller in proportion where they are too many."""
    width, height = area.columns * area.cell[0], area.rows * area.cell[1]
    share = min(1.0, most[0] / width, most[1] / height)
    return max(2, int(width * share) & ~1), max(2, int(height * share) & ~1)
