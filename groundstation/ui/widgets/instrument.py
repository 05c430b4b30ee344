"""What all instruments are: a widget that draws one value as lines and redraws only the lines that changed."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Generic, TypeVar

from rich.segment import Segment
from rich.style import Style
from textual.geometry import Region, Size
from textual.strip import Strip
from textual.widget import Widget

from groundstation.ui.colours import style

Value = TypeVar("Value")


Part = tuple[str, Style]
"""A run of text in one style."""


def strip(*parts: Part) -> Strip:
    """A line of parts; empty ones are left out."""
    return Strip([Segment(text, look) for text, look in parts if text])


def length(parts: Iterable[Part]) -> int:
    """Cells of parts; all our characters are one cell wide."""
    return sum(len(text) for text, _ in parts)


def finite_or_none(value: float | None) -> float | None:
    """A number that can be shown: what a vehicle tells may be NaN."""
    return value if value is not None and math.isfinite(value) else None


class Instrument(Widget, Generic[Value], can_focus=False):
    """Shows the value given last. Subclasses say how by `draw`; everything they draw must come from the value.

    Most of what a frame costs is lines through the compositor, so a value that draws the same line costs nothing.
    """

    def __init__(self, value: Value, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, classes=classes)
        self._value = value
        self._strips: list[Strip] = []
        self._drawn_for = Size(0, 0)

    @property
    def value(self) -> Value:
        """What is shown."""
        return self._value

    def show(self, value: Value) -> None:
        """Show this from now on."""
        if value == self._value:
            return
        self._value = value
        if not self.size or self.size != self._drawn_for:  # not laid out yet, or hidden: drawn when it comes to that
            self._drawn_for = Size(0, 0)
            self.refresh()
            return
        old, new = self._strips, self.draw(*self.size)
        self._strips = new
        changed = [Region(0, y, self.size.width, 1) for y, (a, b) in enumerate(zip(old, new, strict=False)) if a != b]
        if len(old) != len(new):
            self.refresh()
        elif changed:
            self.refresh(*changed)

    def draw(self, width: int, height: int) -> list[Strip]:
        """The lines of the value at this size. Lines that are missing stay blank, those too many are not shown."""
        raise NotImplementedError

    def render_line(self, y: int) -> Strip:
        """Textual asks for each line that must be painted."""
        if self.size != self._drawn_for:
            self._drawn_for = self.size
            self._strips = self.draw(*self.size) if self.size else []
        return self._strips[y] if y < len(self._strips) else Strip.blank(self.size.width, style())
