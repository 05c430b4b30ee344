"""Canvas of braille dots, two by four per cell, with text on top. Used by maps and charts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import cast

from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from groundstation.ui.look.colours import RED
from groundstation.ui.look.colours import style as style_of

_BITS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
"""Bit of each dot in U+2800, by row and column of the cell (Unicode standard, Braille patterns)."""

_RUNS = tuple(
    tuple(tuple(sum(bits[side] for bits in _BITS[above : below + 1]) for below in range(4)) for above in range(4))
    for side in range(2)
)
"""Bits of the dots of one column of a cell, by column, first and last row."""

Point = tuple[float, float]


class Canvas:
    """`width` x `height` cells. Points are in dots from the top left; dots outside are dropped."""

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        self.across, self.down = width * 2, height * 4
        self._dots = [bytearray(width) for _ in range(height)]
        self._styles: list[list[Style]] = [[style_of()] * width for _ in range(height)]
        self._texts: list[dict[int, tuple[str, Style]]] = [{} for _ in range(height)]
        self._strips: list[Strip | None] = [None] * height
        """The strip of each row; None after a change of the row."""

    def dot(self, x: int, y: int, style: Style) -> None:
        """Set one dot. A cell has one colour, that of its last dot."""
        if 0 <= x < self.across and 0 <= y < self.down:
            row, column = y >> 2, x >> 1
            self._dots[row][column] |= _BITS[y & 3][x & 1]
            self._styles[row][column] = style
            self._strips[row] = None

    def run(self, x: int, top: int, bottom: int, style: Style) -> None:
        """Set the dots of one column from `top` down to `bottom`: cell by cell, which is faster than dot by dot."""
        if not 0 <= x < self.across:
            return
        top, bottom = max(0, top), min(self.down - 1, bottom)
        column, side = x >> 1, x & 1
        for row in range(top >> 2, (bottom >> 2) + 1):
            above, below = max(0, top - row * 4), min(3, bottom - row * 4)
            self._dots[row][column] |= _RUNS[side][above][below]
            self._styles[row][column] = style
            self._strips[row] = None

    def line(self, start: Point, end: Point, style: Style) -> None:
        """Set the dots from one point to another."""
        x, y = start
        across, down = end[0] - x, end[1] - y
        steps = max(1, round(max(abs(across), abs(down))))
        if steps > 4 * (self.across + self.down):  # far outside: too many steps
            return
        dots, styles, width, height = self._dots, self._styles, self.across, self.down
        for row in range(max(0, round(min(y, end[1]))) >> 2, (min(height - 1, round(max(y, end[1]))) >> 2) + 1):
            self._strips[row] = None
        for step in range(steps + 1):  # dot(), written out: most of the time of a map goes here
            part = step / steps
            at_x, at_y = round(x + across * part), round(y + down * part)
            if 0 <= at_x < width and 0 <= at_y < height:
                row, column = at_y >> 2, at_x >> 1
                dots[row][column] |= _BITS[at_y & 3][at_x & 1]
                styles[row][column] = style

    def copy(self) -> Canvas:
        """Return a canvas with the same dots and text, which can be drawn on by itself."""
        other = Canvas.__new__(Canvas)
        other.width, other.height, other.across, other.down = self.width, self.height, self.across, self.down
        other._dots = [bytearray(row) for row in self._dots]
        other._styles = [list(row) for row in self._styles]
        other._texts = [dict(row) for row in self._texts]
        other._strips = list(self._strips)
        return other

    def path(self, points: Sequence[Point], style: Style) -> None:
        """Connect points by lines."""
        for start, end in pairwise(points):
            self.line(start, end, style)

    def fill(self, corners: Sequence[Point], style: Style) -> None:
        """Fill a polygon between the crossings of each row of dots with its edges."""
        edges = [*pairwise(corners), (corners[-1], corners[0])]
        top, bottom = min(y for _, y in corners), max(y for _, y in corners)
        for y in range(max(0, round(top)), min(self.down - 1, round(bottom)) + 1):
            crossings = sorted(_crossings(edges, y))
            for left, right in zip(crossings[::2], crossings[1::2], strict=False):
                for x in range(round(left), round(right) + 1):
                    self.dot(x, y, style)

    def write(self, column: int, row: int, text: str, style: Style) -> None:
        """Write text from a cell to the right, cut at the edges."""
        if 0 <= row < self.height:
            self._strips[row] = None
            for offset, character in enumerate(text):
                if 0 <= column + offset < self.width:
                    self._texts[row][column + offset] = (character, style)

    def strips(self) -> list[Strip]:
        """Return one strip per row, with one segment per run of one style; those of unchanged rows again."""
        for row, strip in enumerate(self._strips):
            if strip is None:
                self._strips[row] = Strip(list(self._segments(row)), self.width)
        return cast(list[Strip], list(self._strips))

    def _segments(self, row: int) -> Iterable[Segment]:
        dots, styles, texts = self._dots[row], self._styles[row], self._texts[row]
        run, run_style = "", style_of()
        ground = _has_ground(run_style)
        for column in range(self.width):
            text = texts.get(column)
            character, style = text or (chr(0x2800 + dots[column]) if dots[column] else " ", styles[column])
            blank = text is None and not dots[column] and not ground
            if style is not run_style and not blank and run:
                yield Segment(run, run_style)
                run = ""
            if style is not run_style and not (run and blank):
                run_style, ground = style, _has_ground(style)
            run += character
        if run:
            yield Segment(run, run_style)


def _has_ground(style: Style) -> bool:
    """Return whether a space in this style would be seen: a badge ends with its text."""
    return style.bgcolor != style_of().bgcolor or bool(style.reverse or style.underline)


def _crossings(edges: Iterable[tuple[Point, Point]], y: int) -> Iterable[float]:
    for (x1, y1), (x2, y2) in edges:
        if (y1 <= y) != (y2 <= y):
            yield x1 + (y - y1) * (x2 - x1) / (y2 - y1)


def draw_obstacles(canvas: Canvas, places: Iterable[Point]) -> None:
    """Draw what range sensors see: a blot of 2x2 dots for each direction, on any map."""
    for x, y in places:
        for across, down in ((0, 0), (1, 0), (0, 1), (1, 1)):
            canvas.dot(round(x) + across, round(y) + down, style_of(RED))
