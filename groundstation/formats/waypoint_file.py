"""Missions as text, "QGC WPL 110" (.waypoints, .txt), of Mission Planner, MAVProxy and QGroundControl.

https://mavlink.io/en/file_formats/. Their line 0 is home; a first item that is no waypoint in MAV_FRAME_GLOBAL is taken
for an item, as the rover's own files have it.
"""

from __future__ import annotations

import math
import re

from dialects.command_places import LOCATED
from groundstation.formats.errors import FileFormatError
from groundstation.formats.json_reader import written_place_fault
from groundstation.formats.plan import Plan, as_home, home_item, looks_like_home, move_jumps
from link.services.mission.files import HEADER, PlanFileError, decode_plan
from link.services.mission.items import DEGREES_SCALE, GLOBAL_FRAMES, LOCAL_SCALE, UNSET_COORDINATE, MissionItem
from link.services.param.float32 import same_float32, shortest_float32

_AT_LINE = re.compile(r"line (\d+):? ?")


def parse_waypoints(text: str, source: str) -> Plan:
    """Parse a file. Raises FileFormatError."""
    try:
        items = decode_plan(text.removeprefix("\ufeff").encode("ascii", "replace"), _find_fault)
    except PlanFileError as error:
        raise FileFormatError(f"{source}:{_AT_LINE.sub(lambda found: f'{found[1]}: ', str(error), count=1)}") from error
    if items and looks_like_home(items[0]):
        return Plan(mission=move_jumps(items[1:], -1), home=as_home(items[0]))
    return Plan(mission=items)


def format_waypoints(plan: Plan) -> str:
    """Return the text of a file with a mission, as Mission Planner writes it. Line 0 is home, if one is known."""
    items = plan.mission
    if plan.home is not None or (items and looks_like_home(items[0])):
        items = (home_item(plan.home), *move_jumps(items, 1))
    return "\n".join([HEADER, *(_line(number, item) for number, item in enumerate(items))]) + "\n"


def _find_fault(item: MissionItem, x: float, y: float) -> str | None:
    """Return what is wrong with the place of an item that has one."""
    if item.frame not in GLOBAL_FRAMES or item.command not in LOCATED or any(map(_is_unset, (x, y))):
        return None
    return written_place_fault(x, y)


def _is_unset(degrees: float) -> bool:
    return math.isnan(degrees) or degrees == UNSET_COORDINATE / DEGREES_SCALE  # as _line() writes it


def _line(number: int, item: MissionItem) -> str:
    scale = DEGREES_SCALE if item.frame in GLOBAL_FRAMES else LOCAL_SCALE
    head = (number, int(number == 0), item.frame, item.command)
    params = (_decimal(value, 8) for value in item.params)
    place = (f"{item.x / scale:.8f}", f"{item.y / scale:.8f}", _decimal(item.z, 6))
    return "\t".join(map(str, (*head, *params, *place, int(item.autocontinue))))


def _decimal(value: float, digits: int) -> str:
    """Return the value with this many decimals, or all its digits where that would change it."""
    short = shortest_float32(value)
    text = f"{short:.{digits}f}"
    return text if value != value or same_float32(float(text), value) else repr(short)
