"""The table, the panels and the progress strip of a MapModel, as texts."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

from groundstation.geo import bearing
from groundstation.snapshot import VehicleView
from groundstation.ui.map.model import PLAN_NAMES, MapModel
from groundstation.ui.map.panels import PanelLine, PanelValue, ProgressValue
from groundstation.ui.map.picture import fence_text, mark_of, outside_rows, progress_of, title_of, way_text
from groundstation.ui.map.plan.checks import item_fault, range_warning
from groundstation.ui.map.plan.commands import (
    CHANGE_SPEED,
    DO_JUMP,
    POLYGONS,
    command_title,
    describe_command,
    short_title,
)
from groundstation.ui.map.plan.fields import FRAMES, fields_of, number_text, value_of
from groundstation.ui.map.plan.geometry import place_of
from groundstation.ui.map.plan.plan_time import LegTime, clock_text, leg_times, seconds_of
from groundstation.ui.map.plan_table import PlanTableRow, PlanTableValue
from groundstation.views.plan import MAX_ITEMS, PlanItem, PlanKind

NARROW_VALUE = 5
"""Cells of a value in a narrow table; a longer one loses its unit."""
LEAST_SPEED = 0.1
"""m/s below which the speed of the vehicle is not a base for a time."""


# ---- the table ----


def build_table(model: MapModel, rows: int, *, narrow: bool = False) -> PlanTableValue:
    """Return the part of the edited plan that fits around the selected row; in a narrow table with short names."""
    items, selected = model.editor.rows(), model.editor.selected
    found = model.shown_rows
    home = 1 if model.editor.layer is PlanKind.MISSION and model.home is not None and len(found) == len(items) else 0
    at = found.index(selected) if selected in found else 0
    top = max(0, min(at - rows // 2, len(found) + home - rows))
    shown = [_home_row(model)] if home and top == 0 else []
    begin = max(0, top - home)
    part = found[begin : min(len(found), begin + rows - len(shown))]
    outside, name = outside_rows(model, part), short_title if narrow else command_title
    lines = (*shown, *(_row(model, index, outside, name) for index in part))
    note = _empty_note(model) if not items else "" if found else f"no item has {model.filter.text.strip()!r}"
    return PlanTableValue(lines, at - begin + len(shown) if found else None, _summary(model), note)


def _home_row(model: MapModel) -> PlanTableRow:
    return PlanTableRow("0" if model.first else "⌂", "HOME", look="done")


def _row(model: MapModel, index: int, outside: frozenset[int], name: Callable[[int], str]) -> PlanTableRow:
    layer, row = model.editor.layer, model.editor.rows()[index]
    current, reached = progress_of(model) if layer is PlanKind.MISSION else (None, frozenset())
    edit = mark_of(model, layer, index)
    warned = index in outside or item_fault(row.item) is not None
    state = "▶" if index == current else "✓" if index in reached else ""
    look = "now" if index == current else "edited" if edit else "done" if index in reached else ""
    leg, course = _leg(model, index)
    title, value = name(row.item.command), item_value(row.item, model.first)
    if name is short_title and len(value) > NARROW_VALUE:
        value = value.partition(" ")[0] if row.item.command != DO_JUMP else value
    mark = ("!" if warned else "") + (edit or state)
    return PlanTableRow(str(index + model.first), title, value, leg, course, mark, "warned" if warned else look)


def _leg(model: MapModel, index: int) -> tuple[str, str]:
    """Return length and bearing of the way to an item."""
    if model.editor.layer is not PlanKind.MISSION:
        frame, place = model.ground.frame, place_of(model.editor.rows()[index].item)
        if frame is None or place is None or model.home is None:
            return "", ""
        return _way(model.home, frame.to_point(place))
    route = model.route
    number = route.number.get(index)
    if number is None:
        return "", ""
    before = route.points[number - 1] if number else model.home
    return ("", "") if before is None else _way(before, route.points[number])


def _way(start: tuple[float, float], end: tuple[float, float]) -> tuple[str, str]:
    return f"{math.dist(start, end):.1f}", f"{round(bearing(start, end)) % 360:03}°"


def item_value(item: PlanItem, first: int = 0) -> str:
    """Return the parameter of an item that matters most, with its unit."""
    if item.command == DO_JUMP:
        return f"to {number_text(item.params[0] + first)} x{number_text(item.params[1])}"
    if item.command == CHANGE_SPEED:
        return f"{number_text(item.params[1])} m/s"
    known = describe_command(item.command)
    if known is None or item.command in POLYGONS:
        return ""
    for param in known.params:
        if param.number <= 4 and item.params[param.number - 1] not in (0.0,):
            value = item.params[param.number - 1]
            return "" if math.isnan(value) else f"{number_text(value)} {param.unit}".rstrip()
    return ""


def _summary(model: MapModel) -> str:
    if model.editor.layer is not PlanKind.MISSION or not model.route.points:
        return ""
    parts = [f"{route_length(model):.0f} m in all"]
    if (seconds := _whole_time(model)) is not None:
        parts.append(clock_text(seconds))
    if charge := _charge_at_end(model, _time_left(model)):
        parts.append(f"battery {charge}")
    return " · ".join(parts)


# ---- times ----


def _whole_time(model: MapModel) -> float | None:
    """Return how long the mission takes from home, s; None: not known, or it does not end."""
    legs = _leg_times(model)
    return None if legs is None else seconds_of(model.home, model.route.points, legs)


def _time_left(model: MapModel) -> float | None:
    """Return how long the rest of the mission takes, s: all of it before it begins."""
    current, _ = progress_of(model)
    legs, number = _leg_times(model), model.route.number.get(-1 if current is None else current)
    if _all_done(model) or legs is None:
        return None
    if number is None:
        return _whole_time(model)
    return seconds_of(model.ground.vehicle, model.route.points[number:], legs[number:])


def _leg_times(model: MapModel) -> tuple[LegTime, ...] | None:
    speed = None if model.view is None else model.view.speed
    return leg_times(model.editor.items(PlanKind.MISSION), model.route.indices, speed)


def _charge_at_end(model: MapModel, seconds: float | None) -> str:
    """Return the charge of the battery after a time of driving; empty where that is not known."""
    view = model.view
    if view is None or seconds is None or view.charge is None or view.charge_rate is None:
        return ""
    left = view.charge - view.charge_rate * seconds
    return f"{left:.0%} then" if left > 0 else "EMPTY before"


def route_length(model: MapModel) -> float:
    """Return the length of the mission from home, m."""
    points = model.route.points if model.home is None else (model.home, *model.route.points)
    return sum(math.dist(start, end) for start, end in pairwise(points))


def _empty_note(model: MapModel) -> str:
    view, layer = model.view, model.editor.layer
    if view is None:
        return "no vehicle yet; O opens a file"
    name = PLAN_NAMES[layer]
    if model.replay and not view.plans[layer].version:
        return f"no {name} in the log yet"
    for line in view.running:
        if line.what == f"download {name}":
            return f"loading the {name} {line.done}" + (f"/{line.total}" if line.total is not None else "")
    if not view.plans[layer].version:
        failed = [line for line in view.ended if line.what == f"download {name}" and line.state != "accepted"]
        if failed:
            return f"no {name} ({failed[-1].detail or failed[-1].state})"
        return f"{name} not loaded: D"
    if view.plans[layer].count > MAX_ITEMS:
        return f"{view.plans[layer].count} items, more than {MAX_ITEMS}: mavhelm {layer.name.lower()} get"
    return f"no {name}: a adds an item"


# ---- the item ----


def build_item(model: MapModel, selected: int | None) -> PanelValue:
    """Return the fields of the selected item; `selected` is the field under the cursor."""
    row = model.editor.row
    if row is None:
        return PanelValue((PanelLine("no item", "a adds one here", look="faint"),))
    was, lines = model.editor.was(row), []
    for field in fields_of(row.item):
        value = value_of(row.item, field, model.first)
        before = value_of(was, field, model.first) if was is not None and was.command == row.item.command else value
        note = f"was {before}" if before != value else field.limits
        unit = f" {field.unit}" if field.unit and value != "--" else ""
        lines.append(PanelLine(field.label, value + unit, note, "edited" if before != value else ""))
    if was is not None and was.command != row.item.command:
        lines[0] = PanelLine("command", lines[0].value, f"was {command_title(was.command)}", "edited")
    return PanelValue((*lines, *_item_checks(model, row.item)), selected)


def _item_checks(model: MapModel, item: PlanItem) -> tuple[PanelLine, ...]:
    frame, place = model.ground.frame, place_of(item)
    lines = [PanelLine("frame", FRAMES.get(item.frame, f"frame {item.frame}"), look="faint")]
    if frame is not None and place is not None and model.editor.layer is not PlanKind.FENCE:
        text = fence_text(model, frame.to_point(place), "inside")
        if text:
            outside = text.startswith("OUTSIDE")
            lines.append(PanelLine("fence", text, "" if outside else "✓", "warned" if outside else "good"))
    if fault := item_fault(item) or range_warning(item):
        lines.append(PanelLine("check", fault, look="warned"))
    return tuple(lines)


# ---- here against the vehicle ----


def build_plans(model: MapModel) -> PanelValue:
    """Return one line for each plan, the file, and what U does."""
    lines = [_plan_line(model, kind) for kind in PlanKind]
    lines.append(PanelLine("file", model.file or "--", look="" if model.file else "faint"))
    if layers := model.layers.text:
        lines.append(PanelLine("layers", layers, "hidden, l" if model.layers.hidden else "l hides"))
    diff, name = model.editor.diff(model.editor.layer), model.plan_name
    if diff.count and model.editor.rows():
        lines += [] if layers else [PanelLine("", "")]
        lines.append(PanelLine("U uploads", f"the {name}: {diff.text}", look="edited"))
    return PanelValue(tuple(lines))


def _plan_line(model: MapModel, kind: PlanKind) -> PanelLine:
    view, here, diff = model.view, len(model.editor.rows(kind)), model.editor.diff(kind)
    name = PLAN_NAMES[kind]
    if view is None or not view.plans[kind].version:
        return PanelLine(
            name, f"{here} here · -- there", "not in the log yet" if model.replay else "not loaded", "faint"
        )
    there = view.plans[kind].count
    if diff.count:
        return PanelLine(name, f"{here} here · {there} there", diff.text, "edited")
    if kind is PlanKind.FENCE and here and model.fence_off:
        return PanelLine(name, f"{_count(here)}, OFF", "F switches it on", "warned")
    return PanelLine(name, _count(here), "same ✓", "good")


def _count(number: int) -> str:
    return "none" if number == 0 else "1 item" if number == 1 else f"{number} items"


# ---- progress ----


def build_progress(model: MapModel, vehicle: VehicleView | None) -> ProgressValue:
    """Return the mission as a line, and what comes next."""
    route, total = model.route, route_length(model)
    if not route.points or total <= 0.0:
        return ProgressValue(note="no mission with a way to drive")
    current, reached = progress_of(model)
    points = route.points if model.home is None else (model.home, *route.points)
    shares, way = [], 0.0
    for number, point in enumerate(points):
        way += math.dist(points[number - 1], point) if number else 0.0
        shares.append(way / total)
    shares = shares if model.home is None else shares[1:]
    first = model.view.first if model.view is not None else 0
    stops = tuple(
        (share, str(index + first), "now" if index == current else "done" if index in reached else "")
        for index, share in zip(route.indices, shares, strict=True)
    )  # fmt: skip
    target = next((share for index, share in zip(route.indices, shares, strict=True) if index == current), None)
    left = _left(model, current)
    done = 1.0 - left / total if target is not None and left is not None else float(_all_done(model))
    done = max(0.0, min(target if target is not None else 1.0, done))
    return ProgressValue(stops, done, target or 0.0, _texts(model, vehicle, current, left))


def _all_done(model: MapModel) -> bool:
    return model.view is not None and model.view.state == 5


def _left(model: MapModel, current: int | None) -> float | None:
    """Return the way from the vehicle over the current item to the end, m."""
    route, vehicle = model.route, model.ground.vehicle
    if current is None or current not in route.number or vehicle is None:
        return None
    rest = route.points[route.number[current] :]
    return math.dist(vehicle, rest[0]) + sum(math.dist(a, b) for a, b in pairwise(rest))


def _texts(
    model: MapModel, vehicle: VehicleView | None, current: int | None, left: float | None
) -> tuple[tuple[str, str], ...]:
    view, texts = model.view, []
    if view is None:
        return ()
    if current is not None:
        at = model.route.at(current)
        texts.append(("next", f"{title_of(model, current)} {way_text(model.ground.vehicle, at)}"))
    texts.append(("mission", _STATES.get(view.state, "--")))
    if left is not None:
        texts.append(("left", f"{left:.0f} m{_left_time(model, left, vehicle)}"))
    if view.off_line is not None and current is not None:
        side = "right" if view.off_line >= 0 else "left"
        texts.append(("off the line", f"{abs(view.off_line):.2f} m {side}"))
    if vehicle is not None and vehicle.speed is not None and math.isfinite(vehicle.speed):
        texts.append(("speed", f"{vehicle.speed:z.2f} m/s"))
    if fence := fence_text(model, model.ground.vehicle, "inside"):
        texts.append(("fence", "OFF" if model.fence_idle else fence))
    if charge := _charge_at_end(model, _time_left(model)):
        texts.append(("battery", charge))
    return tuple(texts)


_STATES = {1: "none", 2: "not started", 3: "active", 4: "paused", 5: "complete"}
"""MISSION_STATE."""


def _left_time(model: MapModel, left: float, vehicle: VehicleView | None) -> str:
    """Return the time for the way that is left: by the speeds of the plan, else at the present speed."""
    seconds = _time_left(model)
    if seconds is None:
        speed = vehicle.speed if vehicle is not None else None
        if _leg_times(model) is not None or speed is None or not speed >= LEAST_SPEED:
            return ""
        seconds = left / speed
    return f" {clock_text(seconds)}"
