"""The map as a pane of another screen: the plans as the vehicle has them, everything in view, without a cursor.

The screen gives the views that `PlanCopies.requests` names to `PlanCopies.show_view`, and shows this in a PlanMap.
"""

from __future__ import annotations

from groundstation.geo import LocalFrame, Place, Point
from groundstation.snapshot import VehicleView
from groundstation.ui.map.draw.plan_map_value import MapMark, PlanMapValue
from groundstation.ui.map.draw.scene import (
    build_legs,
    build_marks,
    build_obstacles,
    build_outlines,
    find_reference,
    find_route,
    track_points,
)
from groundstation.ui.map.picture import COMPLETE, no_position
from groundstation.ui.map.plan.copies import PlanCopies
from groundstation.views.plan import PlanKind


def build_pane(copies: PlanCopies, vehicle: VehicleView | None, *, ascii: bool = False) -> PlanMapValue:  # noqa: A002
    """Return the map of the newest view."""
    view = copies.view
    reference = find_reference(view)
    if view is None or reference is None:
        return PlanMapValue(no_position(vehicle))
    frame = LocalFrame(reference)
    mission = copies.items.get(PlanKind.MISSION, ())
    place = _point(frame, view.place)
    home, current = _point(frame, view.home), None if view.state == COMPLETE else view.current
    reached = frozenset(range(len(mission)) if view.state == COMPLETE else view.reached)
    looks = dict.fromkeys(reached, "done") | ({current: "now"} if current is not None else {})
    rally = build_marks(PlanKind.RALLY, copies.items.get(PlanKind.RALLY, ()), frame, {})
    others = tuple(MapMark(frame.to_point(each.place), str(each.system), "other") for each in view.neighbours)
    return PlanMapValue(
        note="",
        home=home,
        vehicle=place,
        obstacles=build_obstacles(place, vehicle),
        heading=None if vehicle is None or vehicle.heading is None else round(vehicle.heading, 1),
        track=track_points(copies.track, frame),
        legs=build_legs(find_route(mission, frame, home), home, current, reached),
        outlines=build_outlines(copies.items.get(PlanKind.FENCE, ()), frame),
        marks=(*rally, *build_marks(PlanKind.MISSION, mission, frame, looks, view.first), *others),
        ascii=ascii,
    )


def _point(frame: LocalFrame, place: Place | None) -> Point | None:
    return None if place is None else frame.to_point(place)
