"""Instrument: a widget that draws one value as lines and redraws only the lines that changed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Generic, TypeVar

from rich.segment import Segment
from rich.style import Style
from textual.geometry import Region, Size
from textual.strip import Strip
from textual.widget import Widget

from groundstation.ui.look.colours import style, theme_changes
from groundstation.ui.terminal.painting import Background, find_background, mark_changed

Value = TypeVar("Value")


CURSOR = "›"
"""First character of the line at the cursor, in every list."""

Part = tuple[str, Style]
"""A run of text in one style."""


def strip(*parts: Part) -> Strip:
    """Return a line of parts without the empty ones."""
    return Strip([Segment(text, look) for text, look in parts if text])


def cropped(line: Strip, width: int) -> Strip:
    """Return a line that is no wider than this; one whose words are cut ends with an ellipsis."""
    if line.cell_length <= width or not line.text[width:].strip():
        return line.crop(0, width)
    kept = list(line.crop(0, max(0, width - 1)))
    return Strip([*kept, Segment("…", kept[-1].style if kept else None)])


def length(parts: Iterable[Part]) -> int:
    """Return the width of parts in cells; all characters that we draw are one cell wide."""
    return sum(len(text) for text, _ in parts)


def finite_or_none(value: float | None) -> float | None:
    """Return the number, None in place of NaN and infinity, which a vehicle may send."""
    return value if value is not None and math.isfinite(value) else None


def _regions_of(lines: Sequence[int], width: int) -> list[Region]:
    """Return the regions of whole lines, in rising order: one for neighbours, of which a picture has many."""
    starts = [at for at, line in enumerate(lines) if not at or lines[at - 1] != line - 1]
    return [Region(0, lines[start], width, end - start) for start, end in pairwise([*starts, len(lines)])]


class Instrument(Widget, Generic[Value], can_focus=False):
    """Shows the newest value. Subclasses implement `draw`, which must depend on nothing but the value and the size.

    Lines in the compositor are the main cost of a frame, so a value that draws the same lines costs little.
    """

    def __init__(self, value: Value, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, classes=classes)
        self._value = value
        self._strips: list[Strip] = []
        self._cursor: tuple[list[Strip], int | None] = ([], None)
        """Lines, and which of them has the cursor."""
        self._drawn_for = (Size(0, 0), theme_changes())
        self._ground: tuple[int, Background | None] = (-1, None)

    @property
    def value(self) -> Value:
        """What is shown."""
        return self._value

    def rows_to(self, line: int) -> int | None:
        """Return how many steps down lead from the cursor to what is drawn on a line; None without a cursor."""
        at = self.cursor_line()
        return None if at is None or line >= len(self._strips) else line - at

    def cursor_line(self) -> int | None:
        """Return the line on which the cursor is drawn."""
        if self._cursor[0] is not self._strips:
            line = next((y for y, drawn in enumerate(self._strips) if drawn.text.startswith(CURSOR)), None)
            self._cursor = self._strips, line
        return self._cursor[1]

    def show(self, value: Value) -> None:
        """Show another value."""
        if value == self._value:
            return
        self._value = value
        size = self.size  # once: the compositor is asked for it
        if not size or self._drawn_for != (size, theme_changes()):  # hidden, or new: render_line draws later
            self._drawn_for = (Size(0, 0), 0)
            if self.display:
                self.refresh()
            return
        old, new = self._strips, self.draw(*size)
        self._strips = new
        pairs = enumerate(zip(old, new, strict=False))
        changed = [y for y, (a, b) in pairs if a is not b and a != b]
        if len(old) != len(new):
            self.refresh()
        elif changed:
            mark_changed(self, _regions_of(changed, size.width))

    def draw(self, width: int, height: int) -> list[Strip]:
        """Return the lines of the value at this size. Missing lines stay blank, surplus lines are not shown."""
        raise NotImplementedError

    def notify_style_update(self) -> None:
        """Forget what the styles were."""
        self._ground = (-1, None)
        super().notify_style_update()

    def render_lines(self, crop: Region) -> list[Strip]:
        """Return lines of the whole widget; without frame and effects of the styles sooner than Textual would."""
        if self._ground[0] != theme_changes():
            self._ground = (theme_changes(), find_background(self))
        ground = self._ground[1]
        if ground is None:
            return super().render_lines(crop)
        size = self.size  # once: the compositor is asked for it
        width = size.width
        lines = [self._drawn_line(y, size).adjust_cell_length(width, ground.style) for y in crop.line_range]
        for each in self.get_line_filters():
            lines = [line.apply_filter(each, ground.colour) for line in lines]
        return lines if crop.column_span == (0, width) else [line.crop(*crop.column_span) for line in lines]

    def render_line(self, y: int) -> Strip:
        """Return one line; Textual calls this for each line that it must paint."""
        return self._drawn_line(y, self.size)

    def _drawn_line(self, y: int, size: Size) -> Strip:
        if self._drawn_for != (size, theme_changes()):
            self._drawn_for = (size, theme_changes())
            self._strips = self.draw(*size) if size else []
        return self._strips[y] if y < len(self._strips) else Strip.blank(size.width, style())
