"""Where the rover may be: a circle around home and the areas of the fence plan. What a breach does is failsafe.py's."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from dialects.enums import FenceItem
from link.services.mission_items import Items
from vehicle.params import Params
from vehicle.place import Origin, Point
from vehicle.plan import POLYGONS

CIRCLE, AREAS = 2, 4
"""Bits of FENCE_TYPE, as ArduPilot's."""
FAR = 100.0
"""m outside from which on nothing drives by itself any more: that far out the position itself is in doubt."""


@dataclass(frozen=True, slots=True)
class Area:
    """A circle (one corner and a radius) or a polygon, to stay inside or outside of."""

    corners: tuple[Point, ...]
    radius: float
    inside: bool
    """It is where the rover may be."""

    def breach(self, place: Point) -> float:
        """m on the wrong side of its edge; 0 on the right one."""
        depth = self.radius - self.corners[0].distance(place) if self.radius else _depth(self.corners, place)
        return max(0.0, -depth if self.inside else depth)


class Fence:
    """The fence in force. The rover must be inside every inclusion and outside every exclusion, as in ArduPilot."""

    def __init__(self, params: Params) -> None:
        self.damage: str | None = None
        """Why the kept fence is lost: where it was nobody knows, so that it is no fence that counts."""
        self.breaches = 0
        """How often the rover has gone beyond it."""
        self.breached_at: float | None = None
        """When it did so last."""
        self._params = params
        self._items: Items = ()
        self._areas: list[Area] = []
        self._origin: Origin | None = None

    @property
    def enabled(self) -> bool:
        """It counts."""
        return bool(self._params["FENCE_ENABLE"])

    @property
    def missing(self) -> str | None:
        """Why nobody may drive inside it, though it counts."""
        return f"{self.damage}, upload it again or set FENCE_ENABLE 0" if self.enabled and self.damage else None

    def load(self, items: Items, damage: str | None = None) -> None:
        """Another plan; it has passed the rules of plan.py. `damage`: why the kept one is lost."""
        self._items, self.damage = items, damage
        self._origin = None

    def breach(self, place: Point, origin: Origin | None, home: Point | None) -> float:
        """m beyond the fence; 0 within, or where there is none."""
        if not self.enabled or origin is None:
            return 0.0
        kinds, breaches = int(self._params["FENCE_TYPE"]), [0.0]
        if kinds & CIRCLE and home is not None:
            breaches.append(home.distance(place) - self._params["FENCE_RADIUS"])
        if kinds & AREAS:
            breaches += [area.breach(place) for area in self._areas_on(origin)]
        return max(breaches)

    def _areas_on(self, origin: Origin) -> list[Area]:
        """In metres; reckoned once for an origin."""
        if origin != self._origin:
            self._origin = origin
            self._areas = _areas(self._items, origin)
        return self._areas


def _areas(items: Items, origin: Origin) -> list[Area]:
    found, index = [], 0
    while index < len(items):
        item = items[index]
        size = int(item.params[0]) if item.command in POLYGONS else 1
        corners = tuple(origin.point(each.latitude, each.longitude) for each in items[index : index + size])
        radius = 0.0 if item.command in POLYGONS else item.params[0]
        inside = item.command in (FenceItem.POLYGON_INCLUSION, FenceItem.CIRCLE_INCLUSION)
        found.append(Area(corners, radius, inside))
        index += size
    return found


def _depth(corners: Sequence[Point], place: Point) -> float:
    """m from the edge of a polygon; negative outside."""
    nearest, inside = math.inf, False
    for start, end in zip(corners, (*corners[1:], corners[0]), strict=True):
        nearest = min(nearest, _to_segment(start, end, place))
        if (start.east > place.east) != (end.east > place.east):
            share = (place.east - start.east) / (end.east - start.east)
            inside ^= place.north < start.north + share * (end.north - start.north)
    return nearest if inside else -nearest


def _to_segment(start: Point, end: Point, place: Point) -> float:
    north, east = end.north - start.north, end.east - start.east
    length = north * north + east * east
    along = 0.0
    if length:
        along = ((place.north - start.north) * north + (place.east - start.east) * east) / length
    along = max(0.0, min(1.0, along))
    return place.distance(Point(start.north + along * north, start.east + along * east))
