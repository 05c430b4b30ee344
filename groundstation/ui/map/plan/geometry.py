"""Places of items, and what is computed from points on a map: (north, east) in m."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from groundstation.geo import Place, Point, is_on_earth
from groundstation.views.plan import PlanItem

DEGREES_SCALE = 1e7
GLOBAL_FRAMES = frozenset({0, 3, 5, 6, 10, 11})
"""MAV_FRAME with latitude and longitude."""
UNSET = 0x7FFF_FFFF
"""INT32_MAX in MISSION_ITEM_INT: no coordinate."""


def place_of(item: PlanItem) -> Place | None:
    """Return where an item is; None for one without a position, with 0, 0 (here) and for one that is not on earth."""
    if item.frame not in GLOBAL_FRAMES or (item.x, item.y) == (0, 0) or UNSET in (item.x, item.y):
        return None
    place = Place(item.x / DEGREES_SCALE, item.y / DEGREES_SCALE)
    return place if is_on_earth(*place) else None


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
