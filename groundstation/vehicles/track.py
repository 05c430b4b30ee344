"""Where the vehicle was: a thinned line of positions, and degrees of latitude and longitude as metres. Bounded."""

from __future__ import annotations

import math

MAX_POINTS = 500
"""More does not fit into a snapshot, nor does a terminal have the dots."""

SPACING = 0.1
"""Least distance of two points at first, m: half the length of a small rover."""

METRES_PER_DEGREE = 111_319.5
"""Of latitude, m (WGS 84 at the equator; the error over a driving ground is below what is drawn)."""


class Track:
    """Positions (north, east) in m; when full, every second point is dropped and points come half as often."""

    def __init__(self) -> None:
        self._points: list[tuple[float, float]] = []
        self._spacing = SPACING

    @property
    def points(self) -> tuple[tuple[float, float], ...]:
        """Oldest first."""
        return tuple(self._points)

    def add(self, position: tuple[float, float]) -> None:
        """The vehicle is here now."""
        if self._points and math.dist(self._points[-1], position) < self._spacing:
            return
        if len(self._points) >= MAX_POINTS:
            self._points = self._points[::2]
            self._spacing *= 2
        self._points.append((round(position[0], 2), round(position[1], 2)))


class LocalFrame:
    """Latitude and longitude as metres from the first position seen."""

    def __init__(self) -> None:
        self._origin: tuple[float, float] | None = None

    def to_local(self, latitude: float, longitude: float) -> tuple[float, float]:
        """North and east of the origin; degrees in."""
        if self._origin is None:
            self._origin = (latitude, longitude)
        north = (latitude - self._origin[0]) * METRES_PER_DEGREE
        east = (longitude - self._origin[1]) * METRES_PER_DEGREE * math.cos(math.radians(self._origin[0]))
        return north, east
