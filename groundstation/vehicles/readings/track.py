"""The vehicle's track: a thinned line of positions. Bounded."""

from __future__ import annotations

import math

MAX_POINTS = 500
"""More do not fit into a snapshot, and a terminal cannot draw more."""

SPACING = 0.1
"""Least distance of two points at first, m: half the length of a small rover."""


class Track:
    """Positions (north, east) in m. When full, every second point is dropped and the spacing doubles."""

    def __init__(self) -> None:
        self._points: list[tuple[float, float]] = []
        self._spacing = SPACING

    @property
    def points(self) -> tuple[tuple[float, float], ...]:
        """Oldest first."""
        return tuple(self._points)

    def add(self, position: tuple[float, float]) -> None:
        """Add the current position, if it is far enough from the last one."""
        if self._points and math.dist(self._points[-1], position) < self._spacing:
            return
        if len(self._points) >= MAX_POINTS:
            self._points = self._points[::2]
            self._spacing *= 2
        self._points.append((round(position[0], 2), round(position[1], 2)))
