"""A line whose escape sequences are ready. Textual would make them again of a style for each cell."""

from __future__ import annotations

from collections.abc import Callable

from rich.console import Console
from rich.segment import Segment
from textual.color import Color
from textual.filter import ANSIToTruecolor, DimFilter, LineFilter
from textual.strip import Strip


class PreparedLine(Strip):
    """Textual's line with the text that draws it; its segments are only made where something lies over a part of it."""

    __slots__ = ("_build", "_built", "_written", "drawn")

    def __init__(self, drawn: str, width: int, build: Callable[[], list[Segment]]) -> None:
        """`build` returns the same line in segments, `width` cells together."""
        self._build = build
        self._built: list[Segment] | None = None
        self._written: int | None = None
        self.drawn = drawn
        """What is written to the terminal."""
        super().__init__((), width)

    @property
    def written(self) -> int:
        """Bytes that are written to the terminal."""
        if self._written is None:
            self._written = len(self.drawn.encode())
        return self._written

    @property
    def _segments(self) -> list[Segment]:
        if self._built is None:
            self._built = self._build()
        return self._built

    @_segments.setter
    def _segments(self, value: list[Segment]) -> None:
        """Keep nothing: the constructor of Textual's class sets an empty list."""

    def render(self, console: Console) -> str:
        """Return what draws the line."""
        return self.drawn

    def apply_filter(self, filter: LineFilter, background: Color) -> Strip:  # noqa: A002
        """Return the line without colours where none are wanted; the other filters of Textual find nothing in it."""
        return self if isinstance(filter, (ANSIToTruecolor, DimFilter)) else super().apply_filter(filter, background)

    def __eq__(self, other: object) -> bool:
        """Return whether another line is prepared and drawn in the same way."""
        return isinstance(other, PreparedLine) and self.drawn == other.drawn

    __hash__ = None  # type: ignore[assignment]  # as Strip
