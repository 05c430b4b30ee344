"""Places on earth as metres around a reference, and what is computed from them. Points are (north, east) in m."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from groundstation.vehicles.track import METRES_PER_DEGREE
from groundstation.views.plan import PlanItem, PlanPlace

Point = tuple[float, float]

DEGREES_SCALE = 1e7
GLOBAL_FRAMES = frozenset({0, 3, 5, 6, 10, 11})
"""MAV_FRAME with latitude and longitude."""
UNSET = 0x7FFF_FFFF
"""INT32_MAX in MISSION_ITEM_INT: no coordinate."""
MAX_LATITUDE, MAX_LONGITUDE = 90.0, 180.0


@dataclass(frozen=True, slots=True)
class LocalMap:
    """Metres around a reference place. The error is 0.1 % at 10 km, more than a small rover drives."""

    reference: PlanPlace

    def to_point(self, place: PlanPlace) -> Point:
        """Return a place in m; across 180 degrees the short way."""
        north = (place.latitude - self.reference.latitude) * METRES_PER_DEGREE
        turned = (place.longitude - self.reference.longitude + 180.0) % 360.0 - 180.0
        return north, turned * METRES_PER_DEGREE * self._shrink

    def to_place(self, point: Point) -> PlanPlace:
        """Return a point as a place, kept on earth."""
        latitude = self.reference.latitude + point[0] / METRES_PER_DEGREE
        longitude = self.reference.longitude + point[1] / (METRES_PER_DEGREE * self._shrink)
        return PlanPlace(max(-MAX_LATITUDE, min(MAX_LATITUDE, latitude)), (longitude + 180.0) % 360.0 - 180.0)

    @property
    def _shrink(self) -> float:
        return max(1e-6, math.cos(math.radians(self.reference.latitude)))


def place_of(item: PlanItem) -> PlanPlace | None:
    """Return where an item is; None for one without a position, with 0, 0 (here) and for one that is not on earth."""
    if item.frame not in GLOBAL_FRAMES or (item.x, item.y) == (0, 0) or UNSET in (item.x, item.y):
        return None
    place = PlanPlace(item.x / DEGREES_SCALE, item.y / DEGREES_SCALE)
    return place if abs(place.latitude) <= MAX_LATITUDE and abs(place.longitude) <= MAX_LONGITUDE else None


def bearing(start: Point, end: Point) -> float:
    """Return the direction from one point to another, degrees clockwise from north, 0..360."""
    return math.degrees(math.atan2(end[1] - start[1], end[0] - start[0])) % 360.0


def is_inside(point: Point, corners: Sequence[Point]) -> bool:
    """Return whether a point is inside a polygon: a ray from it crosses the outline an odd number of times."""
    north, east = point
    inside = False
    for (n1, e1), (n2, e2) in pairwise([*corners, corners[0]]):
        if (n1 > north) != (n2 > north) and east < e1 + (north - n1) * (e2 - e1) / (n2 - n1):
            inside = not inside
    return inside


def distance_to_line(point: Point, start: Point, end: Point) -> float:
    """Return the distance from a point to a line between two points, m."""
    north, east = end[0] - start[0], end[1] - start[1]
    squared = north * north + east * east
    along = 0.0 if squared == 0.0 else ((point[0] - start[0]) * north + (point[1] - start[1]) * east) / squared
    along = max(0.0, min(1.0, along))
    return math.dist(point, (start[0] + along * north, start[1] + along * east))
