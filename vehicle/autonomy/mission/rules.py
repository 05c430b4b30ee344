"""The items that the mission, fence and rally plans of this vehicle may hold.

To support another mission command, add a row here, and its task or effect in vehicle/autonomy/mission/executor.py.
Items for servos and relays are run by vehicle/commands/accessories.py; an item for an output that this vehicle lacks is
reported at the upload and skipped when it is due. A plan that moves a motor as a servo is rejected.
"""

from __future__ import annotations

from collections.abc import Collection
from functools import partial

from dialects.enums import Command, FenceItem, MissionResult, MissionType
from link.services.mission.items import ItemRule, Items, PlanRules, PositionRule
from vehicle.accessories import LARGEST_RELAY, LARGEST_SERVO, PERIOD_MAX, TIMES_MAX
from vehicle.navigation.fence import POLYGONS

DAY = 86400.0
TURNS_MAX = 1000.0
SPEED_LOW, SPEED_HIGH = -2.0, 100.0
"""m/s; -1 means "no change", -2 the default speed."""
RELAY_COMMANDS = (Command.DO_SET_RELAY, Command.DO_REPEAT_RELAY)
SERVO_COMMANDS = (Command.DO_SET_SERVO, Command.DO_REPEAT_SERVO)
ACCESSORY_COMMANDS = (*SERVO_COMMANDS, *RELAY_COMMANDS)
_SERVOS, _RELAYS = (1.0, LARGEST_SERVO), (0.0, LARGEST_RELAY)
_PULSES = (500.0, 2500.0)
"""us; the range of any servo. The limits of a certain servo are checked when it moves."""
_TIMES, _PERIOD = (1.0, TIMES_MAX), (0.0, PERIOD_MAX)
CORNERS_MIN = 3
RADIUS_MAX = 1e5

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
    Command.DO_CHANGE_SPEED: ItemRule(ranges={1: (0.0, 1.0), 2: (SPEED_LOW, SPEED_HIGH)}),
    Command.DO_SET_REVERSE: ItemRule(ranges={1: (0.0, 1.0)}),
    Command.DO_FENCE_ENABLE: ItemRule(ranges={1: (0.0, 1.0)}),
    Command.DO_SET_SERVO: ItemRule(ranges={1: _SERVOS, 2: _PULSES}),
    Command.DO_REPEAT_SERVO: ItemRule(ranges={1: _SERVOS, 2: _PULSES, 3: _TIMES, 4: _PERIOD}),
    Command.DO_SET_RELAY: ItemRule(ranges={1: _RELAYS, 2: (0.0, 1.0)}),
    Command.DO_REPEAT_RELAY: ItemRule(ranges={1: _RELAYS, 2: _TIMES, 3: _PERIOD}),
}

FENCE_RULES: dict[int, ItemRule] = {
    FenceItem.RETURN_POINT: ItemRule(PositionRule.NEEDED),
    FenceItem.POLYGON_INCLUSION: ItemRule(PositionRule.NEEDED, {1: (CORNERS_MIN, 500.0)}),
    FenceItem.POLYGON_EXCLUSION: ItemRule(PositionRule.NEEDED, {1: (CORNERS_MIN, 500.0)}),
    FenceItem.CIRCLE_INCLUSION: ItemRule(PositionRule.NEEDED, {1: (0.1, RADIUS_MAX)}),
    FenceItem.CIRCLE_EXCLUSION: ItemRule(PositionRule.NEEDED, {1: (0.1, RADIUS_MAX)}),
}

RALLY_RULES: dict[int, ItemRule] = {FenceItem.RALLY_POINT: ItemRule(PositionRule.NEEDED)}


def _check_mission(items: Items, motors: Collection[int]) -> MissionResult:
    """Check that DO_JUMP targets exist, numbers are whole, and no servo is a motor."""

    def numbers(*commands: Command) -> list[float]:
        return [item.params[0] for item in items if item.command in commands]

    valid = all(target == int(target) and target < len(items) for target in numbers(Command.DO_JUMP))
    valid &= all(servo == int(servo) and servo not in motors for servo in numbers(*SERVO_COMMANDS))
    valid &= all(relay == int(relay) for relay in numbers(*RELAY_COMMANDS))
    return MissionResult.ACCEPTED if valid else MissionResult.INVALID_PARAM1


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


def plan_rules(motors: Collection[int]) -> dict[MissionType, PlanRules]:
    """Return the rules of each plan; `motors` are the servo outputs of the motors."""
    return {
        MissionType.MISSION: PlanRules(MISSION_RULES, check=partial(_check_mission, motors=motors)),
        MissionType.FENCE: PlanRules(FENCE_RULES, capacity=200, check=_check_fence),
        MissionType.RALLY: PlanRules(RALLY_RULES, capacity=20),
    }
