"""Commands of plans: their numbers, names for people, and how one is found by what somebody types."""

from __future__ import annotations

from groundstation.ui.map.plan.mission_commands import MISSION_COMMANDS, MissionCommand
from groundstation.views.plan import PlanKind

WAYPOINT, RTL, DO_JUMP, CHANGE_SPEED = 16, 20, 177, 178
RETURN_POINT, POLYGON_IN, POLYGON_OUT, CIRCLE_IN, CIRCLE_OUT = 5000, 5001, 5002, 5003, 5004
RALLY_POINT = 5100
POLYGONS, CIRCLES = (POLYGON_IN, POLYGON_OUT), (CIRCLE_IN, CIRCLE_OUT)

NEW_ITEM = {PlanKind.MISSION: WAYPOINT, PlanKind.FENCE: POLYGON_IN, PlanKind.RALLY: RALLY_POINT}
"""What `a` adds."""

_NAMES = {
    RETURN_POINT: "return point", POLYGON_IN: "polygon in", POLYGON_OUT: "polygon out", CIRCLE_IN: "circle in",
    CIRCLE_OUT: "circle out", RALLY_POINT: "rally point",
}  # fmt: skip
_SHORT = {
    WAYPOINT: "waypoint", 17: "loiter", 18: "turns", 19: "loiter", RTL: "RTL", CHANGE_SPEED: "speed", DO_JUMP: "jump",
    92: "guided", 93: "delay", 112: "delay", 114: "distance", 115: "yaw", 181: "relay", 183: "servo", 195: "ROI",
    201: "ROI", RETURN_POINT: "return", POLYGON_IN: "poly in", POLYGON_OUT: "poly out", RALLY_POINT: "rally",
}  # fmt: skip
"""Names for narrow tables."""
_COMMON = (16, 19, 18, 17, 20, 178, 177, 112, 114, 115, 93, 181, 183, 201, 92)
"""Commands of rovers, those first that are used most."""
_WORDS = {"RTL": 20, "SPEED": 178, "JUMP": 177, "LOITER": 19, "DELAY": 112, "RELAY": 181, "SERVO": 183, "ROI": 201}
_FENCE = {_NAMES[command].upper(): command for command in (*POLYGONS, *CIRCLES, RETURN_POINT)}
_MAX_LISTED = 4


def describe_command(command: int) -> MissionCommand | None:
    """Return what is known of a command."""
    return MISSION_COMMANDS.get(command)


def command_title(command: int) -> str:
    """Return the name for the table, without NAV_."""
    if command in _NAMES:
        return _NAMES[command]
    known = MISSION_COMMANDS.get(command)
    return known.name.removeprefix("NAV_") if known else f"command {command}"


def short_title(command: int) -> str:
    """Return the name for a narrow table."""
    return _SHORT.get(command) or command_title(command).removeprefix("DO_").lower()


def has_location(command: int) -> bool:
    """Return whether a command has a position. Of one that is not known it is assumed that it has none."""
    known = MISSION_COMMANDS.get(command)
    return known is not None and known.has_location


def find_command(text: str, kind: PlanKind) -> int | str:
    """Return the command that is meant by a number, a name or a part of it; else what is wrong, one line."""
    words = text.strip().upper().removeprefix("MAV_CMD_")
    if kind is PlanKind.FENCE:
        names = _FENCE
    elif kind is PlanKind.RALLY:
        return RALLY_POINT if words in ("5100", "RALLY POINT") else "the only command of this plan is rally point"
    else:
        names = {each.name: number for number, each in MISSION_COMMANDS.items() if number not in _NAMES}
    if words.isdecimal():
        known = kind is PlanKind.MISSION or int(words) in names.values()
        return int(words) if known and int(words) <= 0xFFFF else f"{words} is not a command of this plan"
    return _find_name(words, names)


def _find_name(words: str, names: dict[str, int]) -> int | str:
    usual = _WORDS.get(words)
    if words not in names and usual in names.values() and usual is not None:
        return usual
    exact = names.get(words) or names.get(f"NAV_{words}") or names.get(f"DO_{words}")
    if exact is not None:
        return exact
    found = [(name, number) for name, number in names.items() if words and words.replace(" ", "_") in name]
    found = found or [(name, number) for name, number in names.items() if words and words in name]
    common = [pair for pair in found if pair[1] in _COMMON]
    chosen = common if len(common) == 1 else found
    if len(chosen) == 1:
        return chosen[0][1]
    if not chosen:
        return f"no command is called {words.lower()!r}"
    listed = ", ".join(name for name, _ in sorted(chosen, key=_order)[:_MAX_LISTED])
    return f"several commands: {listed}" + (" ..." if len(chosen) > _MAX_LISTED else "")


def _order(pair: tuple[str, int]) -> int:
    return _COMMON.index(pair[1]) if pair[1] in _COMMON else len(_COMMON)
