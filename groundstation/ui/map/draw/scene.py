"""What a map shows: from the newest PlanView, a track, the rows of the plans and the vehicle's heading."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import msgspec

from groundstation.geo import LocalFrame, Place, Point, place_around
from groundstation.snapshot import VehicleView
from groundstation.ui.map.draw.plan_map_value import LegState, MapLeg, MapMark, MapOutline
from groundstation.ui.map.plan.checks import fence_shapes
from groundstation.ui.map.plan.commands import CIRCLES, POLYGONS, RETURN_POINT, RTL
from groundstation.ui.map.plan.geometry import place_of
from groundstation.ui.map.plan.rows import Items
from groundstation.ui.widgets.instrument import finite_or_none
from groundstation.views.plan import PlanItem, PlanKind, PlanTrackView, PlanView

NAV_LAST = 95
"""MAV_CMD_NAV_LAST: those up to it are driven to."""

MAX_LEGS = 500
"""Legs drawn; of a longer mission every n-th item."""


class Route(msgspec.Struct, frozen=True):
    """The items of a mission that have a place, in the order in which they are driven."""

    indices: tuple[int, ...] = ()
    points: tuple[Point, ...] = ()
    number: Mapping[int, int] = msgspec.field(default_factory=dict)
    """Index of an item -> its place in `points`."""

    def at(self, index: int | None) -> Point | None:
        """Return where an item is; None for one without a place."""
        number = None if index is None else self.number.get(index)
        return None if number is None else self.points[number]


def find_reference(view: PlanView | None, items: Sequence[Items] = ()) -> Place | None:
    """Return the place around which a map is drawn: home, else the vehicle, else the first item of a plan."""
    if view is not None and (view.home or view.place):
        return view.home or view.place
    return next((place for each in items for item in each if (place := place_of(item))), None)


def find_route(mission: Sequence[PlanItem], frame: LocalFrame, home: Point | None) -> Route:
    """Return the places of a mission; RETURN_TO_LAUNCH is at home."""
    found = []
    for index, item in enumerate(mission):
        place = place_of(item)
        if place is not None and item.command <= NAV_LAST:
            found.append((index, frame.to_point(place)))
        elif item.command == RTL and home is not None:
            found.append((index, home))
    indices = tuple(index for index, _ in found)
    return Route(indices, tuple(point for _, point in found), {index: number for number, index in enumerate(indices)})


def build_legs(route: Route, start: Point | None, current: int | None, reached: frozenset[int]) -> tuple[MapLeg, ...]:
    """Return the legs, from `start` (home) on."""
    indices, points = route.indices, route.points
    thin = max(1, -(-len(points) // MAX_LEGS))
    legs, before = [], start
    for number, (index, point) in enumerate(zip(indices, points, strict=True)):
        if number % thin and number != len(points) - 1:
            continue
        look = LegState.NOW if index == current else LegState.DONE if index in reached else LegState.TO_GO
        if before is not None:
            legs.append(MapLeg(before, point, look))
        before = point
    return tuple(legs)


def build_outlines(fence: Sequence[PlanItem], frame: LocalFrame) -> tuple[MapOutline, ...]:
    """Return the outlines of a fence."""
    return tuple(MapOutline(shape.corners, shape.inclusion) for shape in fence_shapes(fence, frame))


def build_marks(kind: PlanKind, items: Sequence[PlanItem], frame: LocalFrame, looks: dict[int, str], first: int = 0,
                suffix: dict[int, str] | None = None) -> tuple[MapMark, ...]:  # fmt: skip
    """Return the labels of the items of one plan; `looks` and `suffix` by index."""
    marks = []
    for index, item in enumerate(items):
        place = place_of(item)
        if place is None:
            continue
        look, text = _mark(kind, item, index + first)
        look = looks.get(index, look)
        marks.append(MapMark(frame.to_point(place), text + (suffix or {}).get(index, ""), look))
    return tuple(marks)


def _mark(kind: PlanKind, item: PlanItem, number: int) -> tuple[str, str]:
    if kind is PlanKind.RALLY:
        return "rally", "R"
    if kind is PlanKind.MISSION:
        return "item", str(number)
    if item.command in POLYGONS:
        return "corner", "•"
    return "corner", "×" if item.command in CIRCLES else "r" if item.command == RETURN_POINT else "?"


def track_points(track: PlanTrackView | None, frame: LocalFrame) -> tuple[Point, ...]:
    """Return a track as points of a map."""
    if track is None or track.origin is None:
        return ()
    north, east = frame.to_point(track.origin)
    return tuple((north + n, east + e) for n, e in track.points)


def build_obstacles(place: Point | None, vehicle: VehicleView | None) -> tuple[Point, ...]:
    """Return what the range sensors of a vehicle see; nothing where its place or heading is not known."""
    heading = None if vehicle is None else finite_or_none(vehicle.heading)
    if vehicle is None or place is None or heading is None:
        return ()
    return place_around(place, heading, vehicle.obstacles)
