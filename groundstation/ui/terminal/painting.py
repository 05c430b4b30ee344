"""Painting of a screen: only the lines that changed, and as soon as they did.

Textual 8.2.8 renders every widget in the rectangle around all changes, with all its lines, and takes two messages and a
timer from a change to its painting. While driving that was half of the time of the screen's process.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import lru_cache
from itertools import pairwise
from typing import Any, NamedTuple, cast

import msgspec
from rich.console import Console
from rich.control import Control
from rich.style import Style
from textual._compositor import ChopsUpdate, Compositor
from textual.color import Color
from textual.geometry import Region
from textual.screen import Screen
from textual.strip import Strip
from textual.widget import Widget

Span = tuple[int, int, int]
"""Line, first column, column after the last one."""


class _Shown(msgspec.Struct, frozen=True, eq=False):
    """A widget and where it is."""

    widget: Widget
    region: Region
    """All of it."""
    part: Region
    """What is not clipped."""


class LinesUpdate(ChopsUpdate):
    """Moves the cursor by texts that are made once: for each line Textual makes two objects and formats them."""

    def render_segments(self, console: Console) -> str:
        """Return what is written to the terminal, as Textual's own method does."""
        texts: list[str] = []
        last = self.spans[-1][0]
        for y, left, right in self.spans:
            for end, (x, strip) in zip(self.chop_ends[y], self.chops[y].items(), strict=False):
                if strip is None or x > right or end <= left:
                    continue
                whole = left <= x < right and end <= right
                texts += (_move_to(x, y), (strip if whole else strip.crop(0, min(end, right) - x)).render(console))
            if y != last:
                texts.append("\n")
        return "".join(texts)


@lru_cache(1 << 14)
def _move_to(x: int, y: int) -> str:
    """Return what moves the cursor there."""
    return Control.move_to(x, y).segment.text


class LineCompositor(Compositor):
    """Asks only for the lines that changed, and only the widget in front."""

    def __init__(self) -> None:
        super().__init__()
        self._visible: Mapping[Widget, tuple[Region, Region]] = {}
        self._shown: list[_Shown] = []
        self._fronts: dict[int, dict[int, _Shown]] = {}
        """Line -> start of each chop, a part of a line between two cuts -> the widget in front there."""
        self.at_once = False
        """Within painted_at_once."""

    def render_partial_update(self) -> ChopsUpdate | None:
        """Return what changed since the last update; None: nothing."""
        spans = list(self._regions_to_spans(self._dirty_regions))
        self._dirty_regions.clear()
        if not spans:
            return None
        self._note_layout()
        cuts = self.cuts
        chops: dict[int, dict[int, Strip | None]] = {y: dict.fromkeys(cuts[y][:-1]) for y, _, _ in spans}
        for shown, lines in self._changed_lines(spans).items():
            self._render(shown, lines, chops)
        return LinesUpdate(cast(Sequence[dict[int, Strip | None]], chops), spans, [each[1:] for each in cuts])

    def _note_layout(self) -> None:
        """Forget which widgets are in front, if the layout has changed: then there is another object of them."""
        visible = self.visible_widgets
        if visible is not self._visible:
            self._visible, self._fronts = visible, {}
            self._shown = [
                _Shown(widget, region, region.intersection(clip)) for widget, (region, clip) in visible.items()
            ]

    def _changed_lines(self, spans: Iterable[Span]) -> dict[_Shown, list[int]]:
        """Return which lines of the screen to ask each widget for, in rising order."""
        found: dict[_Shown, list[int]] = {}
        for y, start, end in spans:
            cuts, fronts = self.cuts[y], self._front_widgets(y)
            for left, right in pairwise(cuts):
                if left < end and right > start and left in fronts:
                    lines = found.setdefault(fronts[left], [])
                    if not lines or lines[-1] != y:
                        lines.append(y)
        return found

    def _front_widgets(self, y: int) -> Mapping[int, _Shown]:
        """Return the widget in front of each chop of a line; the visible ones are in order, the first one in front."""
        if y not in self._fronts:
            found: dict[int, _Shown] = {}
            self._fronts[y] = found
            for shown in self._shown:
                part = shown.part
                if part.y <= y < part.bottom:
                    for cut in self.cuts[y][:-1]:
                        if part.x <= cut < part.right:
                            found.setdefault(cut, shown)
        return self._fronts[y]

    def _render(self, shown: _Shown, lines: Sequence[int], chops: Mapping[int, dict[int, Strip | None]]) -> None:
        """Put lines of a widget where it is in front."""
        region, part = shown.region, shown.part
        first, count = lines[0], lines[-1] - lines[0] + 1
        strips = shown.widget.render_lines(Region(part.x - region.x, first - region.y, part.width, count))
        for y in lines:
            inner = [cut for cut in self.cuts[y] if part.x <= cut <= part.right]
            line = strips[y - first]
            whole = len(inner) == 2 and line.cell_length == part.width
            pieces = (line,) if whole else line.divide([cut - part.x for cut in inner[1:]])
            for cut, piece in zip(inner, pieces, strict=False):
                if self._fronts[y].get(cut) is shown:
                    chops[y][cut] = piece


class Background(NamedTuple):
    """What is behind the lines of a widget."""

    colour: Color
    style: Style
    """Of what its lines leave blank at their ends."""


def find_background(widget: Widget) -> Background | None:
    """Return the ground of a widget that is its lines and nothing else; None for one with a frame or effects."""
    styles = widget.styles
    edges = any(edge for edge, _ in styles.outline)
    effects = widget.opacity != 1.0 or styles.text_opacity != 1.0 or styles.tint.a or styles.has_rule("hatch")
    if any(styles.gutter) or edges or effects:
        return None
    behind, colour = widget.background_colors
    inner, _ = widget._styles_cache.get_inner_outer(behind, colour)
    return Background(colour, inner.rich_style)


def visible_regions(screen: Screen[Any]) -> Iterator[tuple[Widget, Region]]:
    """Yield each widget that is on the screen, and where it is. Costs no search of all widgets, as a query does."""
    return ((widget, region) for widget, (region, _) in screen._compositor.visible_widgets.items())


def mark_changed(widget: Widget, regions: Iterable[Region]) -> None:
    """Have parts of a widget painted, which keeps its size: at the end of `painted_at_once`, else a little later."""
    screen = widget.screen
    widget._set_dirty(*regions)
    screen._dirty_widgets.add(widget)
    compositor = screen._compositor
    if not (isinstance(compositor, LineCompositor) and compositor.at_once):
        screen.check_idle()


@contextmanager
def painted_at_once(screen: Screen[Any]) -> Iterator[None]:
    """Paint what changes within the block at its end: Textual's timer, up to 16 ms later, is not needed then."""
    compositor = cast(LineCompositor, screen._compositor)
    compositor.at_once = True
    try:
        yield
    finally:
        compositor.at_once = False
    screen._on_timer_update()
    if screen._dirty_widgets:  # another screen is on top
        screen.check_idle()
