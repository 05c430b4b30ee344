"""Plans of QGroundControl (.plan): mission, fence and rally points as JSON.

https://docs.qgroundcontrol.com/master/en/qgc-dev-guide/file_formats/plan.html
"""

from __future__ import annotations

import json
import math
from typing import Any

from dialects.enums import Command, FenceItem, MissionType
from groundstation.formats.errors import shown
from groundstation.formats.json_reader import JsonReader, load_object
from groundstation.formats.plan import Plan, PlannedHome, kind_of
from link.services.mission.items import (
    DEGREES_SCALE,
    GLOBAL_FRAMES,
    UNSET_COORDINATE,
    Items,
    MissionItem,
    coordinate_scale,
    to_int32,
)
from link.services.param.float32 import shortest_float32

MAX_ITEMS = 10_000
RELATIVE = 3
"""MAV_FRAME_GLOBAL_RELATIVE_ALT."""
_RELATIVE_MODE, _ABSOLUTE_MODE = 1, 2
"""AltitudeMode of QGroundControl."""
_SETTINGS = {"cruiseSpeed": 15, "firmwareType": 0, "globalPlanAltitudeMode": 1, "hoverSpeed": 5, "vehicleType": 10}


# ---- reading ----


def parse_plan(text: str, source: str) -> Plan:
    """Parse a file. Raises FileFormatError, with `source` and the place in it."""
    root = JsonReader(load_object(text, source, "a plan"), source)
    if root.get("fileType", str) != "Plan":
        root.fail(f'"fileType" is {shown(str(root.value["fileType"]))}, not "Plan"')
    _check_version(root, 1)
    mission = root.at("mission")
    _check_version(mission, 2)
    items = mission.items("items", MAX_ITEMS)
    home = mission.numbers("plannedHomePosition", 3) if "plannedHomePosition" in mission.value else None
    settings = {name: value for name, value in mission.value.items() if name in _SETTINGS}
    return Plan(
        mission=_jumps_by_index([pair for item in items for pair in _mission_items(item)]),
        fence=_fence(root.at("geoFence")) if "geoFence" in root.value else (),
        rally=_rally(root.at("rallyPoints")) if "rallyPoints" in root.value else (),
        home=PlannedHome(*home) if home else None,
        settings=settings,
    )


def _mission_items(item: JsonReader) -> list[tuple[int | None, MissionItem]]:
    """Return a simple item with its doJumpId, or those that a survey has written out."""
    kind = item.get("type", str)
    if kind in ("SimpleItem", "missionItem"):  # the second before 3.3
        return [_simple_item(item)]
    style = item.value.get("TransectStyleComplexItem")
    if kind == "ComplexItem" and isinstance(style, dict) and "Items" in style:
        return [_simple_item(each) for each in item.at("TransectStyleComplexItem").items("Items", MAX_ITEMS)]
    return item.fail(f"{shown(str(item.value.get('complexItemType', kind)))} has no items that can be uploaded")


def _check_version(part: JsonReader, newest: int) -> None:
    """Refuse a part of a version that is newer than what is known here."""
    if "version" in part.value and part.whole("version", MAX_ITEMS) > newest:
        part.fail(f'"version" is {shown(str(part.value["version"]))}, and {newest} is the newest that is known here')


def _simple_item(item: JsonReader) -> tuple[int | None, MissionItem]:
    frame, command = item.whole("frame", 255), item.whole("command", 65535)
    if (kind := kind_of(command)) is not MissionType.MISSION:
        item.fail(f"command {command} belongs to {_PLACES[kind]}, not to a mission")
    one, two, three, four, x, y, z = _params(item)
    return (
        item.whole("doJumpId", 65535) if "doJumpId" in item.value else None,
        MissionItem(command, frame, (one, two, three, four), *_place(item, command, frame, x, y), _zero(z),
                    item.value.get("autoContinue", True) is True),
    )  # fmt: skip


_PLACES = {MissionType.FENCE: "geoFence", MissionType.RALLY: "rallyPoints"}


def _params(item: JsonReader) -> list[float]:
    """Return the seven parameters.

    QGroundControl before 3.3 wrote the last three as `coordinate`, and at first the others as param1 to param4
    (MissionItem.cc, _convertJsonV1ToV2 and _convertJsonV2ToV3).
    """
    if "coordinate" not in item.value:
        return item.numbers("params", 7, empty=math.nan)
    if "params" in item.value:
        params = item.numbers("params", 4, empty=math.nan)
    else:
        params = [item.number(f"param{number}") for number in range(1, 5)]
    return [*params, *item.numbers("coordinate", 3, empty=math.nan)]


def _place(item: JsonReader, command: int, frame: int, x: float, y: float) -> tuple[int, int]:
    """Return `x` and `y` of MISSION_ITEM_INT."""
    scale = coordinate_scale(command, frame)
    if scale != DEGREES_SCALE:
        return to_int32(_zero(x), scale), to_int32(_zero(y), scale)
    if not math.isnan(x) and not math.isnan(y):
        item.check_place(x, y)
    return to_int32(x, DEGREES_SCALE), to_int32(y, DEGREES_SCALE)


def _jumps_by_index(items: list[tuple[int | None, MissionItem]]) -> Items:
    """Return the items; DO_JUMP names its target by index and not by doJumpId, which counts from 1."""
    index = {jump: at for at, (jump, _) in enumerate(items) if jump is not None}
    moved: list[MissionItem] = []
    for _, item in items:
        if item.command == Command.DO_JUMP:
            target, two, three, four = item.params
            to = index.get(int(target), int(target) - 1) if math.isfinite(target) else target
            item = MissionItem(
                item.command, item.frame, (float(to), two, three, four), item.x, item.y, item.z, item.autocontinue
            )
        moved.append(item)
    return tuple(moved)


def _fence(fence: JsonReader) -> Items:
    _check_version(fence, 2)
    found: list[MissionItem] = []
    if fence.value.get("polygon"):  # version 1: one polygon to stay in
        found += _corners(fence, FenceItem.POLYGON_INCLUSION)
    for polygon in fence.items("polygons", MAX_ITEMS):
        inside = polygon.get("inclusion", bool)
        found += _corners(polygon, FenceItem.POLYGON_INCLUSION if inside else FenceItem.POLYGON_EXCLUSION)
    for circle in fence.items("circles", MAX_ITEMS):
        kind = FenceItem.CIRCLE_INCLUSION if circle.get("inclusion", bool) else FenceItem.CIRCLE_EXCLUSION
        shape = circle.at("circle")
        found.append(_point(shape, kind, shape.numbers("center", 2), shape.number("radius")))
    if "breachReturn" in fence.value:
        latitude, longitude, altitude = fence.numbers("breachReturn", 3)
        found.append(_point(fence, FenceItem.RETURN_POINT, [latitude, longitude], 0.0, altitude))
    return tuple(found)


def _corners(shape: JsonReader, kind: FenceItem) -> list[MissionItem]:
    corners = shape.items_of_numbers("polygon", 2)
    if len(corners) < 3:
        shape.fail("a polygon needs at least three corners")
    return [_point(shape, kind, corner, float(len(corners))) for corner in corners]


def _rally(rally: JsonReader) -> Items:
    _check_version(rally, 2)
    points = rally.items_of_numbers("points", 3)
    return tuple(_point(rally, FenceItem.RALLY_POINT, point[:2], 0.0, point[2]) for point in points)


def _point(where: JsonReader, kind: FenceItem, place: list[float], first: float, altitude: float = 0.0) -> MissionItem:
    where.check_place(*place)
    x, y = (to_int32(each, DEGREES_SCALE) for each in place)
    return MissionItem(kind, RELATIVE, (first, 0.0, 0.0, 0.0), x, y, altitude)


def _zero(value: float) -> float:
    return 0.0 if math.isnan(value) else value


# ---- writing ----


def format_plan(plan: Plan) -> str:
    """Return the text of a file, as QGroundControl writes it. Fence items that it does not know are left out."""
    home = plan.home or _first_place(plan)
    document = {
        "fileType": "Plan",
        "geoFence": _fence_json(plan.fence),
        "groundStation": "mavhelm",
        "mission": {
            **_SETTINGS,
            **plan.settings,
            "items": [_item_json(number, item) for number, item in enumerate(plan.mission)],
            "plannedHomePosition": [_number(each) for each in (home.latitude, home.longitude, home.altitude)],
            "version": 2,
        },
        "rallyPoints": {
            "points": [[item.latitude, item.longitude, _float32(item.z)] for item in plan.rally],
            "version": 2,
        },
        "version": 1,
    }
    return json.dumps(document, indent=4, sort_keys=True) + "\n"


def _first_place(plan: Plan) -> PlannedHome:
    """Return where the plan begins: QGroundControl does not read a plan without home."""
    places = (each for each in (*plan.mission, *plan.rally, *plan.fence) if each.frame in GLOBAL_FRAMES)
    first = next((each for each in places if (each.x, each.y) != (0, 0) and each.x != UNSET_COORDINATE), None)
    return PlannedHome(first.latitude, first.longitude, 0.0) if first else PlannedHome(0.0, 0.0, 0.0)


def _item_json(number: int, item: MissionItem) -> dict[str, Any]:
    params = [_float32(value) for value in item.params]
    if item.command == Command.DO_JUMP and math.isfinite(item.params[0]):
        params[0] = int(item.params[0]) + 1
    scale = coordinate_scale(item.command, item.frame)
    place = [None if each == UNSET_COORDINATE else _number(each / scale) for each in (item.x, item.y)]
    fields: dict[str, Any] = {
        "autoContinue": item.autocontinue,
        "command": item.command,
        "doJumpId": number + 1,
        "frame": item.frame,
        "params": [*params, *place, _float32(item.z)],
        "type": "SimpleItem",
    }
    if item.frame in GLOBAL_FRAMES:
        mode = _ABSOLUTE_MODE if item.frame in (0, 5) else _RELATIVE_MODE
        fields |= {"AMSLAltAboveTerrain": None, "Altitude": _float32(item.z), "AltitudeMode": mode}
    return fields


def _fence_json(items: Items) -> dict[str, Any]:
    circles: list[Any] = []
    polygons: list[Any] = []
    result: dict[str, Any] = {"circles": circles, "polygons": polygons, "version": 2}
    at = 0
    while at < len(items):
        item, count = items[at], 1
        inside = item.command in (FenceItem.CIRCLE_INCLUSION, FenceItem.POLYGON_INCLUSION)
        if item.command in (FenceItem.CIRCLE_INCLUSION, FenceItem.CIRCLE_EXCLUSION):
            shape = {"center": [item.latitude, item.longitude], "radius": _float32(item.params[0])}
            circles.append({"circle": shape, "inclusion": inside, "version": 1})
        elif item.command in (FenceItem.POLYGON_INCLUSION, FenceItem.POLYGON_EXCLUSION):
            count = max(1, int(item.params[0])) if math.isfinite(item.params[0]) else 1
            corners = [[each.latitude, each.longitude] for each in items[at : at + count]]
            polygons.append({"inclusion": inside, "polygon": corners, "version": 1})
        elif item.command == FenceItem.RETURN_POINT:
            result["breachReturn"] = [item.latitude, item.longitude, _float32(item.z)]
        at += count
    return result


def _number(value: float) -> float | int | None:
    """Return a number as QGroundControl writes it: null for NaN, whole numbers without a point."""
    if not math.isfinite(value):
        return None
    return int(value) if value == int(value) and abs(value) < 1e15 else value


def _float32(value: float) -> float | int | None:
    """Return a number that was a float32 on the wire, with no more digits than that."""
    return _number(shortest_float32(value))
