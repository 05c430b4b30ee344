"""MapWindow: which part of the ground a map shows. Scale and middle change in steps: it rarely moves."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec

from groundstation.geo import Point

SCALES = tuple(step * 10.0**decade for decade in range(-2, 4) for step in (1.0, 1.4, 2.0, 3.0, 5.0, 7.0))
"""m per dot that a map may have."""
CLOSEST = SCALES.index(0.05)
"""A closer view would show the noise of GPS only."""
FITTED = SCALES.index(0.1)
"""A fit comes no closer: an empty plan begins with some ten metres around the vehicle."""
MARGIN = 0.42
"""Share of the width and height on each side of the middle in which everything lies after a fit."""


class MapWindow(msgspec.Struct, frozen=True):
    """The middle (north, east) in m, and the index of its scale in SCALES."""

    north: float = 0.0
    east: float = 0.0
    zoom: int = SCALES.index(0.2)

    @property
    def scale(self) -> float:
        """Metres per dot."""
        return SCALES[self.zoom]

    def to_dots(self, point: Point, across: int, down: int) -> Point:
        """Return a point in dots from the top left of a canvas."""
        x = across / 2 + (point[1] - self.east) / self.scale
        return x, down / 2 - (point[0] - self.north) / self.scale

    def zoomed(self, by: int) -> MapWindow:
        """Return a closer view (-1) or a wider one (+1) of the same middle."""
        return MapWindow(self.north, self.east, max(CLOSEST, min(len(SCALES) - 1, self.zoom + by)))

    def shows(self, point: Point, across: int, down: int, margin: float = 0.5) -> bool:
        """Return whether a point lies within this share of the width and height around the middle."""
        wide, tall = abs(point[1] - self.east) / self.scale, abs(point[0] - self.north) / self.scale
        return wide <= across * margin and tall <= down * margin

    def around(self, point: Point, across: int, down: int) -> MapWindow:
        """Return the view moved so that the point is well inside, in steps of an eighth of its size."""
        if self.shows(point, across, down, MARGIN):
            return self
        step = max(self.scale, self.scale * min(across, down) / 8)
        return MapWindow(round(point[0] / step) * step, round(point[1] / step) * step, self.zoom)


def fit_window(points: Sequence[Point], across: int, down: int) -> MapWindow:
    """Return the closest view of all points."""
    if not points:
        return MapWindow()
    norths, easts = [north for north, _ in points], [east for _, east in points]
    for zoom in range(FITTED, len(SCALES)):
        step = SCALES[zoom] * 4
        window = MapWindow(_middle(norths, step), _middle(easts, step), zoom)
        if all(window.shows(each, across, down, MARGIN) for each in _corners(norths, easts)):
            break
    return window


def _middle(values: Sequence[float], step: float) -> float:
    return round((min(values) + max(values)) / 2 / step) * step


def _corners(norths: Sequence[float], easts: Sequence[float]) -> tuple[Point, Point]:
    return (min(norths), min(easts)), (max(norths), max(easts))


def ring_spacing(at_least: float) -> float:
    """Return a round number of m, 1, 2 or 5 times a power of ten."""
    decade = 10.0 ** math.floor(math.log10(at_least))
    return next((step * decade for step in (1.0, 2.0, 5.0) if step * decade >= at_least), 10 * decade)
