"""The trail that the rover has driven since it was armed, for SMART_RTL."""

from __future__ import annotations

from vehicle.navigation.geo import Point

TRAIL_SPACING = 1.0
"""m between two points of the trail: finer than the corners that this rover can drive around."""
TRAIL_MAX = 500
"""Points. A full trail drops every second point and doubles its spacing."""


class Trail:
    """Places where the rover has been, without the loops that it drove."""

    def __init__(self) -> None:
        self.points: list[Point] = []
        self._spacing = TRAIL_SPACING

    def clear(self) -> None:
        """Forget the trail."""
        self.points.clear()
        self._spacing = TRAIL_SPACING

    def add(self, place: Point) -> None:
        """Add the present place; a return to an earlier point removes the loop in between."""
        if self.points and self.points[-1].distance(place) < self._spacing:
            return
        near = next((index for index, point in enumerate(self.points) if point.distance(place) < self._spacing), None)
        if near is not None:
            del self.points[near + 1 :]
            return
        self.points.append(place)
        if len(self.points) > TRAIL_MAX:
            del self.points[1::2]
            self._spacing *= 2
