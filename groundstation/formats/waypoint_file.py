"""Plans as text, "QGC WPL 110" (.waypoints, .txt), of Mission Planner, MAVProxy and QGroundControl: one kind of items.

https://mavlink.io/en/file_formats/. Their line 0 is home; a first item that is no waypoint in MAV_FRAME_GLOBAL is taken
for an item, as the rover's own files have it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

from msgspec.structs import replace

from dialects.command_places import LOCATED, PLACELESS
from dialects.enums import Command, MissionType
from groundstation.formats.errors import FileFormatError
from groundstation.formats.json_reader import written_place_fault
from groundstation.formats.plan import Plan, PlannedHome, as_home, home_item, kind_of, looks_like_home, move_jumps
from link.services.mission.files import HEADER, PlanFileError, decode_plan
from link.services.mission.items import (
    DEGREES_SCALE,
    FRAME_MISSION,
    GLOBAL_FRAMES,
    UNSET_COORDINATE,
    Items,
    MissionItem,
    coordinate_scale,
)
from link.services.param.float32 import same_float32, shortest_float32

_USUAL_FRAME = 3
"""MAV_FRAME_GLOBAL_RELATIVE_ALT, which Mission Planner writes for commands without a place, too."""
_AT_LINE = re.compile(r"line (\d+):? ?")


def parse_waypoints(text: str, source: str) -> Plan:
    """Parse a file. Raises FileFormatError."""
    try:
        items = decode_plan(text.removeprefix("\ufeff").encode("ascii", "replace"), _find_fault)
    except PlanFileError as error:
        raise FileFormatError(f"{source}:{_AT_LINE.sub(lambda found: f'{found[1]}: ', str(error), count=1)}") from error
    if items and looks_like_home(items[0]):
        return _sorted_plan(items, 1, as_home(items[0]))
    return _sorted_plan(items, 0, None)


def _sorted_plan(items: Items, first: int, home: PlannedHome | None) -> Plan:
    """Return the items from `first` on in the plan that each belongs to by its command.

    `fence save` and `rally save` of MAVProxy and Mission Planner write this format, too.
    """
    mission = [at for at in range(first, len(items)) if kind_of(items[at].command) is MissionType.MISSION]
    places = {at: place for place, at in enumerate(mission)}
    return Plan(
        mission=tuple(_move_jump(items[at], places, first) for at in mission),
        fence=tuple(item for item in items[first:] if kind_of(item.command) is MissionType.FENCE),
        rally=tuple(item for item in items[first:] if kind_of(item.command) is MissionType.RALLY),
        home=home,
    )


def _move_jump(item: MissionItem, places: Mapping[int, int], first: int) -> MissionItem:
    """Return a DO_JUMP with its target, the number of a line, as the index in the mission."""
    target, *others = item.params
    if item.command != Command.DO_JUMP or not math.isfinite(target):
        return item
    one, two, three = others
    return replace(item, params=(float(places.get(int(target), int(target) - first)), one, two, three))


def format_waypoints(plan: Plan) -> str:
    """Return the text of a file with one kind of items, as Mission Planner writes it.

    Line 0 of a mission is home, if one is known. Raises FileFormatError for several kinds. What the format cannot hold
    is 0 in it: `lost_values` says so.
    """
    if len(plan.kinds) > 1:
        raise FileFormatError("a mission, a fence and rally points together fit into a .plan only")
    items = plan.mission or plan.fence or plan.rally
    is_mission = not (plan.fence or plan.rally)
    if is_mission and (plan.home is not None or (items and looks_like_home(items[0]))):
        items = (home_item(plan.home), *move_jumps(items, 1))
    return "\n".join([HEADER, *(_line(number, item) for number, item in enumerate(items))]) + "\n"


def lost_values(plan: Plan) -> str:
    """Return what format_waypoints() cannot write, as one line; "" if that is nothing.

    Mission Planner refuses a line with `nan`, and a place that is not on Earth (pymavlink issue 1096).
    """
    items = (*plan.mission, *plan.fence, *plan.rally)
    count = sum(any(map(math.isnan, (*item.params, item.z))) or _has_unset_place(item) for item in items)
    if not count:
        return ""
    found = "1 item has" if count == 1 else f"{count} items have"
    return f"{found} values that are not set (NaN), 0 in this file: a .plan keeps them"


def _find_fault(item: MissionItem, x: float, y: float) -> str | None:
    """Return what is wrong with the place of an item that has one."""
    if item.frame not in GLOBAL_FRAMES or item.command not in LOCATED or any(map(_is_unset, (x, y))):
        return None
    return written_place_fault(x, y)


def _is_unset(degrees: float) -> bool:
    return math.isnan(degrees) or degrees == UNSET_COORDINATE / DEGREES_SCALE  # as the rover's own files have it


def _has_unset_place(item: MissionItem) -> bool:
    return UNSET_COORDINATE in (item.x, item.y)


def _line(number: int, item: MissionItem) -> str:
    scale = coordinate_scale(item.command, item.frame)
    x, y = (0 if each == UNSET_COORDINATE else each / scale for each in (item.x, item.y))
    no_frame = item.frame == FRAME_MISSION and item.command in PLACELESS
    frame = _USUAL_FRAME if no_frame else item.frame
    head = (number, int(number == 0), frame, item.command)
    params = (_decimal(value, 8) for value in item.params)
    place = (f"{x:.8f}", f"{y:.8f}", _decimal(item.z, 6))
    return "\t".join(map(str, (*head, *params, *place, int(item.autocontinue))))


def _decimal(value: float, digits: int) -> str:
    """Return the value with this many decimals, or all its digits where that would change it; NaN is 0."""
    short = 0.0 if math.isnan(value) else shortest_float32(value)
    text = f"{short:.{digits}f}"
    return text if same_float32(float(text), short) else repr(short)
