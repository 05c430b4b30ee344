"""Drawing on a canvas that is a part of the ground: lines, marks, the vehicle, the cursor, and the map's frame."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from rich.style import Style

from groundstation.geo import Point
from groundstation.ui.look.colours import (
    AMBER,
    BACKGROUND,
    BLACK,
    BLUE,
    DIM,
    FAINT,
    GREEN,
    LINE,
    RED,
    TEXT,
    WHITE,
    YELLOW,
    style,
)
from groundstation.ui.map.draw.plan_map_value import LegState, MapOutline, MapShape, PlanMapValue
from groundstation.ui.map.draw.window import MapWindow, ring_spacing
from groundstation.ui.widgets.canvas import Canvas

WIDE = 70
"""Columns from which the legend has room."""
MAX_RINGS = 12
MAX_NAMES = 60
"""Names of shapes that are written."""
CROSS = 5
"""Dots of an arm of the cursor."""


MARKS: dict[str, tuple[str, str]] = {
    "item": (TEXT, FAINT),
    "done": (DIM, FAINT),
    "now": (BLACK, YELLOW),
    "edited": (BLACK, BLUE),
    "selected": (BACKGROUND, TEXT),
    "rally": (BLACK, GREEN),
    "corner": (RED, BACKGROUND),
    "other": (AMBER, FAINT),
}
"""How a mark is drawn -> colour of its text and of its ground."""
LEGS = {LegState.DONE: (GREEN, 2, 2), LegState.NOW: (YELLOW, 1, 0), LegState.TO_GO: (TEXT, 1, 1)}
"""Colour, dots and gap."""

_LEGEND = (
    ("⌂", (AMBER, BACKGROUND), "home"),
    (" R ", MARKS["rally"], "rally"),
    ("╶╶", (RED, BACKGROUND), "fence"),
    ("──", (YELLOW, BACKGROUND), "leg now"),
    ("··", (TEXT, BACKGROUND), "to go"),
    ("──", (BLUE, BACKGROUND), "track"),
)
"""Mark, its colours, and what it is."""


class PlanDrawing:
    """A canvas and the part of the ground on it."""

    def __init__(self, canvas: Canvas, window: MapWindow) -> None:
        self._canvas = canvas
        self._window = window

    def at(self, point: Point) -> Point:
        """Return where a point is, in dots."""
        return self._window.to_dots(point, self._canvas.across, self._canvas.down)

    def dashes(self, start: Point, end: Point, look: Style, dots: int, gap: int) -> None:
        """Draw a line of dots and gaps; what lies outside costs nothing."""
        clipped = _clip(self.at(start), self.at(end), self._canvas.across, self._canvas.down)
        if clipped is None:
            return
        (x1, y1), (x2, y2) = clipped
        steps = max(1, round(max(abs(x2 - x1), abs(y2 - y1))))
        for step in range(steps + 1):
            if step % (dots + gap) < dots:
                part = step / steps
                self._canvas.dot(round(x1 + (x2 - x1) * part), round(y1 + (y2 - y1) * part), look)

    def path(self, points: tuple[Point, ...], look: Style) -> None:
        """Connect points."""
        for start, end in pairwise(points):
            self.dashes(start, end, look, 1, 0)

    def layers(self, shapes: Sequence[MapShape]) -> None:
        """Draw the shapes of files, with the names of the first ones."""
        for shape in shapes:
            ends = (*shape.points, shape.points[0]) if shape.closed else shape.points
            self.path(ends, style(DIM))
            if len(shape.points) == 1:
                self.write(shape.points[0], "+", style(DIM, bold=True))
        for shape in [each for each in shapes if each.name][:MAX_NAMES]:
            x, y = self.at(_middle(shape.points))
            if 0 <= x < self._canvas.across and 0 <= y < self._canvas.down:
                self._canvas.write((int(x) >> 1) + 2, int(y) >> 2, shape.name, style(DIM))

    def outline(self, outline: MapOutline) -> None:
        """Draw a fence: long dashes around where the vehicle may be, short ones around where it may not."""
        dots, gap = (4, 2) if outline.inclusion else (2, 2)
        for start, end in zip(outline.corners, (*outline.corners[1:], outline.corners[0]), strict=True):
            self.dashes(start, end, style(RED), dots, gap)
        if not outline.inclusion:
            self.write(_middle(outline.corners), "✗", style(RED))

    def rings(self, centre: Point) -> None:
        """Draw faint rings around home."""
        canvas, (x, y) = self._canvas, self.at(centre)
        spacing = self.ring / self._window.scale
        farthest = math.hypot(max(x, canvas.across - x), max(y, canvas.down - y))
        for number in range(1, min(MAX_RINGS, int(farthest / spacing)) + 1):
            radius = spacing * number
            for step in range(count := max(16, int(radius * math.tau / 9))):
                angle = step * math.tau / count
                canvas.dot(round(x + radius * math.cos(angle)), round(y + radius * math.sin(angle)), style(LINE))

    @property
    def ring(self) -> float:
        """Spacing of the rings, and length of the scale, m."""
        return ring_spacing(self._window.scale * max(8, min(self._canvas.across, self._canvas.down)) / 5)

    def write(self, point: Point, text: str, look: Style) -> None:
        """Write a text around a point."""
        x, y = self.at(point)
        if abs(x) < 1e6 and abs(y) < 1e6:
            self._canvas.write((int(x) >> 1) - (len(text) - 1) // 2, int(y) >> 2, text, look)

    def labels(self, value: PlanMapValue) -> None:
        """Write home and the marks, those that matter most over the others."""
        if value.home is not None:
            self.write(value.home, "⌂", style(AMBER, bold=True))
        order = list(MARKS)
        last = ("now", "edited", "selected")
        for mark in sorted(value.marks, key=lambda each: last.index(each.look) if each.look in last else -1):
            text = mark.text if mark.look == "corner" else f" {mark.text} "
            self.write(mark.point, text, style(*MARKS[mark.look if mark.look in order else "item"]))

    def vehicle(self, value: PlanMapValue) -> None:
        """Draw the vehicle with its heading."""
        if value.vehicle is None:
            return
        x, y = self.at(value.vehicle)
        if value.heading is None or value.ascii:
            mark = "●" if value.heading is None else "^>v<"[round(value.heading / (math.pi / 2)) % 4]
            self.write(value.vehicle, mark, style(YELLOW, bold=True))
            return
        along, aside = math.sin(value.heading), math.cos(value.heading)
        corners = [(9.0, 0.0), (-4.5, 4.0), (-2.0, 0.0), (-4.5, -4.0)]  # dots ahead, dots to the right
        self._canvas.fill([(x + a * along + b * aside, y - a * aside + b * along) for a, b in corners], style(YELLOW))

    def cross(self, cursor: Point | None, measured: Point | None) -> None:
        """Draw the cursor, and the line that is measured to it."""
        if cursor is None:
            return
        if measured is not None:
            self.dashes(measured, cursor, style(BLUE), 3, 1)
            self.write(measured, "○", style(BLUE, bold=True))
        x, y = (round(each) for each in self.at(cursor))
        for step in (*range(-2 * CROSS, -2, 2), *range(4, 2 * CROSS + 1, 2)):
            self._canvas.dot(x + step, y | 1, style(WHITE))
            self._canvas.dot(x | 1, y + step, style(WHITE))
        self.write(cursor, "┼", style(WHITE, bold=True))

    def frame(self, value: PlanMapValue) -> None:
        """Write north, the legend, the scale and the lines about the cursor."""
        canvas = self._canvas
        canvas.write(1, 0, "N", style(RED, bold=True))
        if canvas.width >= WIDE:
            self._legend(canvas)
        bar = max(2, round(self.ring / self._window.scale / 2))
        bottom = canvas.height - 1
        if bar < canvas.width // 2:
            canvas.write(1, bottom - len(value.lines), "├" + "─" * (bar - 1) + "┤ " + metres(self.ring), style(DIM))
        for up, line in enumerate(reversed(value.lines)):
            canvas.write(max(0, canvas.width - len(line) - 1), bottom - up, line, style(TEXT))

    def _legend(self, canvas: Canvas) -> None:
        column = canvas.width - sum(len(mark) + len(word) + 2 for mark, _, word in _LEGEND)
        for mark, look, word in _LEGEND:
            canvas.write(column, 0, mark, style(*look))
            canvas.write(column + len(mark) + 1, 0, word, style(DIM))
            column += len(mark) + len(word) + 2


def metres(distance: float) -> str:
    """Return a distance in words."""
    return f"{distance:g} m" if distance < 1000 else f"{distance / 1000:g} km"


def _middle(points: Sequence[Point]) -> Point:
    """Return the middle of points."""
    north, east = (sum(values) / len(points) for values in zip(*points, strict=True))
    return north, east


def _clip(start: Point, end: Point, across: int, down: int) -> tuple[Point, Point] | None:
    """Return the part of a line that is on the canvas (Liang and Barsky); None if none is."""
    (x, y), (x2, y2) = start, end
    dx, dy = x2 - x, y2 - y
    first, last = 0.0, 1.0
    for step, room in ((-dx, x), (dx, across - x), (-dy, y), (dy, down - y)):
        if step == 0:
            if room < 0:
                return None
            continue
        cut = room / step
        first, last = (max(first, cut), last) if step < 0 else (first, min(last, cut))
    return ((x + first * dx, y + first * dy), (x + last * dx, y + last * dy)) if first <= last else None
