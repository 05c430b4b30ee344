"""Pictures of a MapModel: the values of the map, the table, the panels and the strip."""

from __future__ import annotations

import math
from collections.abc import Iterable

from msgspec.structs import replace

from groundstation.geo import Point, bearing
from groundstation.snapshot import VehicleView
from groundstation.ui.map.draw.ground import NOT_FITTED, Looking
from groundstation.ui.map.draw.plan_map_value import MapMark, PlanMapValue
from groundstation.ui.map.draw.scene import build_legs, build_marks, build_obstacles, build_outlines, track_points
from groundstation.ui.map.model import PLAN_NAMES, MapModel
from groundstation.ui.map.plan.checks import check_fence, fence_shapes
from groundstation.ui.map.plan.commands import command_title
from groundstation.ui.map.plan.geometry import place_of
from groundstation.views.plan import PlanKind

LEAST_WAY = 0.05
"""m; a shorter way is drawn as 0.0 and has no direction."""
COMPLETE = 5
"""MISSION_STATE."""


def build_map(model: MapModel, vehicle: VehicleView | None, *, ascii: bool = False) -> PlanMapValue:  # noqa: A002
    """Return the map."""
    frame, view = model.ground.frame, model.view
    if frame is None:
        return PlanMapValue(no_position(vehicle))
    mission = model.editor.rows(PlanKind.MISSION)
    current, reached = progress_of(model)
    value = PlanMapValue(
        note="",
        home=model.home,
        vehicle=model.ground.vehicle,
        obstacles=build_obstacles(model.ground.vehicle, vehicle),
        heading=None if vehicle is None or vehicle.heading is None else round(vehicle.heading, 1),
        track=track_points(model.copies.track, frame),
        legs=build_legs(model.route, model.home, current if mission else None, reached),
        outlines=build_outlines(model.editor.items(PlanKind.FENCE), frame),
        layers=model.layers.shapes(frame),
        layer_corners=model.layers.corners(frame),
        marks=_marks(model),
        ascii=ascii,
    )
    model.ground.look(value.points)
    neighbours = view.neighbours if view is not None else ()
    others = tuple(MapMark(frame.to_point(each.place), str(each.system), "other") for each in neighbours)
    return replace(
        value,
        marks=(*value.marks, *others),
        window=None if model.ground.window is NOT_FITTED else model.ground.window,
        cursor=model.ground.cursor_point,
        measured=None if model.ground.measured is None else frame.to_point(model.ground.measured),
    )


def progress_of(model: MapModel) -> tuple[int | None, frozenset[int]]:
    """Return the current item and those that are done, as rows of the mission as the vehicle has it.

    Indices are those of the vehicle's plan; an edited plan maps them by the origins of its rows.
    """
    view = model.view
    if view is None:
        return None, frozenset()
    rows = model.editor.rows(PlanKind.MISSION)
    by_origin = {row.origin: index for index, row in enumerate(rows) if row.origin is not None}
    done = set(view.reached)
    if view.state == COMPLETE:
        done |= set(by_origin) - {None}
    current = by_origin.get(view.current) if view.current is not None and view.state != COMPLETE else None
    return current, frozenset(by_origin[index] for index in done if index in by_origin)


def mark_of(model: MapModel, kind: PlanKind, index: int) -> str:
    """Return what differs from the vehicle's plan: + new, ✎ changed."""
    row = model.editor.rows(kind)[index]
    if row.origin is None:
        return "+"
    return "✎" if model.editor.was(row, kind) is not None else ""


def _marks(model: MapModel) -> tuple[MapMark, ...]:
    frame = model.ground.frame
    if frame is None:
        return ()
    current, reached = progress_of(model)
    found: list[MapMark] = []
    for kind in (PlanKind.FENCE, PlanKind.RALLY, PlanKind.MISSION):
        if kind is PlanKind.FENCE and model.editor.layer is not kind:
            continue  # its outlines are enough
        items = model.editor.items(kind)
        edits = {index: mark for index in range(len(items)) if (mark := mark_of(model, kind, index))}
        looks = dict.fromkeys(edits, "edited")
        if kind is PlanKind.MISSION:
            looks = dict.fromkeys(reached, "done") | looks | ({current: "now"} if current is not None else {})
        if kind is model.editor.layer and model.editor.row is not None:
            looks[model.editor.selected] = "selected"
        first = model.view.first if model.view is not None and kind is PlanKind.MISSION else 0
        found += build_marks(kind, items, frame, looks, first, edits)
    return tuple(found)


def no_position(vehicle: VehicleView | None) -> str:
    """Return why there is no map."""
    if vehicle is None:
        return "no vehicle, and no plan: O opens a file"
    if vehicle.gps_fix is None:
        return "no position: no GPS reported"
    fix = {0: "no GPS", 1: "no fix", 2: "2D fix"}.get(vehicle.gps_fix, "3D fix, not estimated yet")
    satellites = "" if vehicle.gps_satellites is None else f", {vehicle.gps_satellites} satellites"
    return f"no position: {fix}{satellites}"


# ---- texts about places ----


def way_text(start: Point | None, end: Point | None) -> str:
    """Return distance and bearing, "--" where a point is not known."""
    if start is None or end is None:
        return "--"
    distance = math.dist(start, end)
    direction = bearing(start, end) if distance >= LEAST_WAY else 0.0
    return f"{distance:.1f} m {round(direction) % 360:03}°"


def cursor_lines(model: MapModel, *, narrow: bool) -> tuple[str, ...]:
    """Return where the cursor is: on earth, from the vehicle and from home, or what is measured."""
    ground, point = model.ground, model.ground.cursor_point
    if ground.cursor is None or point is None:
        return ()
    at = f"{ground.cursor.latitude:.6f} {ground.cursor.longitude:.6f}"
    name = "" if model.view is None or narrow else f"{model.view.name} "
    way, home = f"{name}{way_text(ground.vehicle, point)}", f"home {way_text(model.home, point)}"
    if ground.measured is not None and ground.frame is not None:
        way = f"measured {way_text(ground.frame.to_point(ground.measured), point)}"
    following = "following" if ground.looking is Looking.FOLLOW else ""
    fence = "fence OFF" if narrow and model.fence_idle else fence_text(model, point)
    parts = (f"cursor {way}", at, home, fence, following) if narrow else (following, f"cursor {at}", way, home, fence)
    return (" · ".join(part for part in parts if part),)


def fence_text(model: MapModel, point: Point | None, inside: str = "fence") -> str:
    """Return where a point is with regard to the fence; empty without a fence. `inside`: the word for inside."""
    frame = model.ground.frame
    if frame is None or point is None:
        return ""
    check = check_fence(point, fence_shapes(model.editor.items(PlanKind.FENCE), frame))
    if check is None:
        return ""
    off = ", fence OFF" if model.fence_idle else ""
    return f"{inside if check.inside else 'OUTSIDE'} {check.distance:.0f} m{off}"


def title_of(model: MapModel, index: int) -> str:
    """Return number and command of a mission item."""
    rows = model.editor.rows(PlanKind.MISSION)
    first = model.view.first if model.view is not None else 0
    return f"{index + first} {command_title(rows[index].item.command)}" if index < len(rows) else ""


def layer_title(model: MapModel) -> str:
    """Return the layers, the edited one marked."""
    parts = (f"✎ {PLAN_NAMES[kind]}" if kind is model.editor.layer else PLAN_NAMES[kind] for kind in PlanKind)
    return " · ".join(parts)


def outside_rows(model: MapModel, among: Iterable[int]) -> frozenset[int]:
    """Return which of these rows of the edited plan lie outside the fence."""
    frame = model.ground.frame
    if frame is None or model.editor.layer is PlanKind.FENCE:
        return frozenset()
    shapes = fence_shapes(model.editor.items(PlanKind.FENCE), frame)
    found = set()
    for index in among:
        place = place_of(model.editor.rows()[index].item)
        check = check_fence(frame.to_point(place), shapes) if place is not None else None
        if check is not None and not check.inside:
            found.add(index)
    return frozenset(found)
