"""Checks of a plan before it is uploaded: what no vehicle can use, and what the operator should know."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec

from groundstation.geo import LocalFrame, Point, place_fault
from groundstation.ui.map.plan.commands import CIRCLE_IN, CIRCLES, DO_JUMP, POLYGON_IN, has_location
from groundstation.ui.map.plan.fields import fields_of, range_fault
from groundstation.ui.map.plan.geometry import (
    DEGREES_SCALE,
    GLOBAL_FRAMES,
    UNSET,
    distance_to_line,
    is_inside,
    place_of,
)
from groundstation.ui.map.plan.rows import polygon_spans
from groundstation.views.plan import PlanItem

LEAST_CORNERS = 3


class FenceShape(msgspec.Struct, frozen=True):
    """A polygon, or a circle as a polygon; points in m."""

    corners: tuple[Point, ...]
    inclusion: bool
    centre: Point | None = None
    radius: float = 0.0

    def contains(self, point: Point) -> bool:
        """Return whether a point is inside."""
        if self.centre is not None:
            return math.dist(self.centre, point) <= self.radius
        return is_inside(point, self.corners)

    def distance(self, point: Point) -> float:
        """Return the distance of a point to the outline, m."""
        if self.centre is not None:
            return abs(math.dist(self.centre, point) - self.radius)
        ends = (*self.corners[1:], self.corners[0])
        return min(distance_to_line(point, start, end) for start, end in zip(self.corners, ends, strict=True))


class FenceCheck(msgspec.Struct, frozen=True):
    """Where a point is with regard to a fence."""

    inside: bool
    distance: float
    """m to the nearest outline."""


def fence_shapes(items: Sequence[PlanItem], frame: LocalFrame, arc: int = 24) -> tuple[FenceShape, ...]:
    """Return the shapes of a fence; those that are not complete are left out. `arc`: corners drawn for a circle."""
    shapes = []
    for first, count in polygon_spans(items):
        corners = [frame.to_point(place) for item in items[first : first + count] if (place := place_of(item))]
        if len(corners) >= LEAST_CORNERS:
            shapes.append(FenceShape(tuple(corners), items[first].command == POLYGON_IN))
    for item in items:
        place, radius = place_of(item), item.params[0]
        if item.command in CIRCLES and place is not None and math.isfinite(radius) and radius > 0:
            north, east = frame.to_point(place)
            angles = [math.tau * step / arc for step in range(arc)]
            round_it = tuple((north + radius * math.cos(each), east + radius * math.sin(each)) for each in angles)
            shapes.append(FenceShape(round_it, item.command == CIRCLE_IN, (north, east), radius))
    return tuple(shapes)


def check_fence(point: Point, shapes: Sequence[FenceShape]) -> FenceCheck | None:
    """Return where a point is; None without a fence. Inside is: in all inclusions and in no exclusion."""
    if not shapes:
        return None
    inside = all(shape.contains(point) == shape.inclusion for shape in shapes)
    return FenceCheck(inside, min(shape.distance(point) for shape in shapes))


def item_fault(item: PlanItem) -> str | None:
    """Return why no vehicle can use an item: a position that is not on earth, a parameter that is infinite."""
    is_placed = item.frame in GLOBAL_FRAMES and has_location(item.command) and UNSET not in (item.x, item.y)
    if is_placed and (fault := place_fault(item.x / DEGREES_SCALE, item.y / DEGREES_SCALE)):
        return fault
    if not math.isfinite(item.z) and not math.isnan(item.z):
        return "the altitude is infinite"
    return "a parameter is infinite" if any(map(math.isinf, item.params)) else None


def plan_fault(items: Sequence[PlanItem], first: int = 0) -> str | None:
    """Return the first reason why a plan is not uploaded, with the number of its item; None: it can be."""
    for index, item in enumerate(items):
        if fault := item_fault(item):
            return f"item {index + first}: {fault}"
        if item.command == DO_JUMP and not 0 <= item.params[0] < len(items):  # also false for NaN
            return f"item {index + first}: it jumps to an item that does not exist"
    for at, count in polygon_spans(items):
        wanted = items[at].params[0]
        if count < LEAST_CORNERS:
            return f"item {at + first}: a polygon needs {LEAST_CORNERS} corners, this one has {count}"
        if count != wanted:
            return f"item {at + first}: the polygon shall have {wanted:g} corners and has {count}"
    return None


def range_warning(item: PlanItem) -> str | None:
    """Return the first value that is out of the range of its parameter; vehicles may take it nevertheless."""
    for field in fields_of(item):
        fault = range_fault(field, item.params[int(field.key) - 1]) if field.key in "1234" else ""
        if fault:
            return fault
    return None
