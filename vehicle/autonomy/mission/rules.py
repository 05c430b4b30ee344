"""The items that the mission, fence and rally plans of this vehicle may hold.

To add a mission item that drives (NAV_, CONDITION_), add a row to MISSION_RULES and its task to executor.py. A DO_ item
has its row beside its MAV_CMD handler in vehicle/commands (`DoItem`), because its command runs the same code.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import msgspec

from dialects.enums import Command, FenceItem, MissionResult, MissionType
from link.services.mission.items import ItemRule, Items, MissionItem, PlanRules, PositionRule
from vehicle.navigation.fence import POLYGONS

DAY = 86400.0
TURNS_MAX = 1000.0
CORNERS_MIN = 3
RADIUS_MAX = 1e5


class DoItem(msgspec.Struct, frozen=True):
    """A MAV_CMD as a DO item of a mission. It runs beside the drive to the next NAV item."""

    rule: ItemRule
    run: Callable[[MissionItem, float], None]
    """Called when the mission reaches the item; the item has passed `rule` and `accepts`."""
    accepts: Callable[[MissionItem], bool] = lambda item: True
    """False rejects an upload with INVALID_PARAM1."""
    unsupported_reason: Callable[[MissionItem], str | None] = lambda item: None
    """Return why this vehicle will skip the item, or None. The driver reads it at the upload."""


_GO = ItemRule(PositionRule.NEEDED, {1: (0.0, DAY)})
_HERE = ItemRule(PositionRule.OPTIONAL)

MISSION_RULES: dict[int, ItemRule] = {
    Command.NAV_WAYPOINT: _GO,
    Command.NAV_LOITER_UNLIM: _HERE,
    Command.NAV_LOITER_TURNS: ItemRule(PositionRule.OPTIONAL, {1: (0.0, TURNS_MAX)}),
    Command.NAV_LOITER_TIME: ItemRule(PositionRule.OPTIONAL, {1: (0.0, DAY)}),
    Command.NAV_RETURN_TO_LAUNCH: ItemRule(),
    Command.NAV_DELAY: ItemRule(ranges={1: (0.0, DAY)}),
    Command.CONDITION_DELAY: ItemRule(ranges={1: (0.0, DAY)}),
    Command.CONDITION_DISTANCE: ItemRule(ranges={1: (0.0, RADIUS_MAX)}),
    Command.CONDITION_YAW: ItemRule(ranges={1: (-360.0, 360.0), 4: (0.0, 1.0)}),
    Command.DO_JUMP: ItemRule(ranges={1: (0.0, 65535.0), 2: (-1.0, 65535.0)}),
}

FENCE_RULES: dict[int, ItemRule] = {
    FenceItem.RETURN_POINT: ItemRule(PositionRule.NEEDED),
    FenceItem.POLYGON_INCLUSION: ItemRule(PositionRule.NEEDED, {1: (CORNERS_MIN, 500.0)}),
    FenceItem.POLYGON_EXCLUSION: ItemRule(PositionRule.NEEDED, {1: (CORNERS_MIN, 500.0)}),
    FenceItem.CIRCLE_INCLUSION: ItemRule(PositionRule.NEEDED, {1: (0.1, RADIUS_MAX)}),
    FenceItem.CIRCLE_EXCLUSION: ItemRule(PositionRule.NEEDED, {1: (0.1, RADIUS_MAX)}),
}

RALLY_RULES: dict[int, ItemRule] = {FenceItem.RALLY_POINT: ItemRule(PositionRule.NEEDED)}


def _check_mission(items: Items, do_items: Mapping[int, DoItem]) -> MissionResult:
    """Check that every jump has a target and that every DO item accepts its parameters."""
    jumps = (item.params[0] for item in items if item.command == Command.DO_JUMP)
    sane = all(target == int(target) and target < len(items) for target in jumps)
    sane &= all(do_items[item.command].accepts(item) for item in items if item.command in do_items)
    return MissionResult.ACCEPTED if sane else MissionResult.INVALID_PARAM1


def _check_fence(items: Items) -> MissionResult:
    """Check that the corners of each polygon are complete, and that there is at most one return point."""
    if sum(item.command == FenceItem.RETURN_POINT for item in items) > 1:
        return MissionResult.INVALID
    index = 0
    while index < len(items):
        item = items[index]
        size = int(item.params[0]) if item.command in POLYGONS else 1
        corners = items[index : index + size]
        if len(corners) < size or any((each.command, each.params[0]) != (item.command, item.params[0])
                                      for each in corners):  # fmt: skip
            return MissionResult.INVALID_PARAM1
        index += size
    return MissionResult.ACCEPTED


def plan_rules(do_items: Mapping[int, DoItem]) -> dict[MissionType, PlanRules]:
    """Return the rules of each plan; `do_items` are the DO_ commands that a mission may hold."""
    commands = {**MISSION_RULES, **{command: item.rule for command, item in do_items.items()}}
    return {
        MissionType.MISSION: PlanRules(commands, check=partial(_check_mission, do_items=do_items)),
        MissionType.FENCE: PlanRules(FENCE_RULES, capacity=200, check=_check_fence),
        MissionType.RALLY: PlanRules(RALLY_RULES, capacity=20),
    }


def find_unsupported_items(items: Items, do_items: Mapping[int, DoItem]) -> list[str]:
    """Report items that will be skipped: a plan of another vehicle runs without them, as in ArduPilot."""
    found = {
        number: reason
        for number, item in enumerate(items)
        if item.command in do_items and (reason := do_items[item.command].unsupported_reason(item))
    }
    if not found:
        return []
    numbers, reasons = ", ".join(map(str, found)), ", ".join(dict.fromkeys(found.values()))
    return [f"Mission: no accessory for items {numbers}, will be skipped: {reasons}"]
