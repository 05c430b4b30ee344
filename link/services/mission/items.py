"""One item of a mission, fence or rally plan, how it comes and goes on the wire, and what makes one invalid."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum

from dialects import messages as m
from dialects.enums import MissionResult

DEGREES_SCALE = 1e7
"""`x` and `y` of MISSION_ITEM_INT are degrees times this, in global frames."""
LOCAL_SCALE = 1e4
"""...and metres times this in local ones."""
UNSET_COORDINATE = 0x7FFF_FFFF
"""INT32_MAX: the integer that stands for NaN."""
GLOBAL_FRAMES = frozenset({0, 3, 5, 6, 10, 11})
"""MAV_FRAME with latitude and longitude: GLOBAL, _RELATIVE_ALT, _TERRAIN_ALT and their _INT."""
FRAME_MISSION = 2
"""MAV_FRAME_MISSION: the item has no place."""
MAX_LATITUDE, MAX_LONGITUDE = 90.0, 180.0
_FAULTS = {
    1: MissionResult.INVALID_PARAM1,
    2: MissionResult.INVALID_PARAM2,
    3: MissionResult.INVALID_PARAM3,
    4: MissionResult.INVALID_PARAM4,
    7: MissionResult.INVALID_PARAM7,
}


@dataclass(frozen=True, slots=True)
class MissionItem:
    """One item, whichever message brought it. Its place in the plan is its index there."""

    command: int
    """MAV_CMD."""
    frame: int
    """MAV_FRAME."""
    params: tuple[float, float, float, float]
    """Parameters 1..4; NaN where the sender leaves it to the vehicle."""
    x: int
    """Latitude in 1e-7 degrees, or north in 1e-4 m, by frame."""
    y: int
    z: float
    """Altitude, m."""
    autocontinue: bool = True

    @property
    def latitude(self) -> float:
        """Degrees; only in a global frame."""
        return self.x / DEGREES_SCALE

    @property
    def longitude(self) -> float:
        """Degrees; only in a global frame."""
        return self.y / DEGREES_SCALE


Items = tuple[MissionItem, ...]
"""A plan."""


class PositionRule(Enum):
    """What a command does with latitude and longitude."""

    NONE = 0
    """They are not looked at, nor is the frame."""
    OPTIONAL = 1
    """0/0 or NaN means here."""
    NEEDED = 2
    """They must be a place; 0/0 is none."""


@dataclass(frozen=True, slots=True)
class ItemRule:
    """What an item of one command must be."""

    place: PositionRule = PositionRule.NONE
    ranges: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    """Parameter 1..4 or 7 -> smallest and largest value. One that is named here must be a number, others may be NaN."""


@dataclass(frozen=True, slots=True)
class PlanRules:
    """What one kind of plan may hold."""

    commands: Mapping[int, ItemRule]
    """The commands known; others are UNSUPPORTED."""
    capacity: int = 500
    frames: frozenset[int] = GLOBAL_FRAMES
    check: Callable[[Items], MissionResult] = lambda items: MissionResult.ACCEPTED
    """Looks at the whole: jumps that lead nowhere, polygons without a third corner."""

    def validate(self, items: Sequence[MissionItem]) -> MissionResult:
        """ACCEPTED, or what is wrong with a whole plan."""
        if len(items) > self.capacity:
            return MissionResult.NO_SPACE
        wrong = self.first_invalid(items)
        fault = None if wrong is None else item_fault(wrong[1], self.commands, self.frames)
        return self.check(tuple(items)) if fault is None else fault

    def first_invalid(self, items: Sequence[MissionItem]) -> tuple[int, MissionItem] | None:
        """The first item that is invalid by itself, and its number."""
        return next((each for each in enumerate(items) if item_fault(each[1], self.commands, self.frames)), None)


def item_fault(
    item: MissionItem, rules: Mapping[int, ItemRule], frames: frozenset[int] = GLOBAL_FRAMES
) -> MissionResult | None:
    """Why an item is invalid, or None. `rules` are the commands known, `frames` those understood."""
    rule = rules.get(item.command)
    if rule is None:
        return MissionResult.UNSUPPORTED
    if item.frame not in frames and not (rule.place is PositionRule.NONE and item.frame == FRAME_MISSION):
        return MissionResult.UNSUPPORTED_FRAME
    return _bad_parameter(item, rule) or (_bad_place(item, rule.place) if item.frame in GLOBAL_FRAMES else None)


def describe_rejection(wrong: tuple[int, MissionItem] | None, verdict: MissionResult) -> str:
    """What is wrong with a plan: an item, with its number, or how they fit together."""
    if verdict is MissionResult.NO_SPACE:
        return "it has too many items"
    if wrong is None:
        return "its items do not fit together"
    number, item = wrong
    match verdict:
        case MissionResult.UNSUPPORTED:
            return f"item {number}, command {item.command} not offered"
        case MissionResult.UNSUPPORTED_FRAME:
            return f"item {number}, frame {item.frame} not offered"
    return f"item {number}, {verdict.name.lower().replace('_', ' ')}"


def _bad_parameter(item: MissionItem, rule: ItemRule) -> MissionResult | None:
    for number, value in (*enumerate(item.params, start=1), (7, item.z)):
        low, high = rule.ranges.get(number, (-math.inf, math.inf))
        unnamed_nan = math.isnan(value) and number not in rule.ranges
        if math.isinf(value) or not (unnamed_nan or low <= value <= high):
            return _FAULTS[number]
    return None


def _bad_place(item: MissionItem, place: PositionRule) -> MissionResult | None:
    if place is PositionRule.NONE:
        return None
    nowhere = UNSET_COORDINATE in (item.x, item.y) or (item.x, item.y) == (0, 0)
    if nowhere:
        return MissionResult.INVALID_X if place is PositionRule.NEEDED else None
    if abs(item.latitude) > MAX_LATITUDE:
        return MissionResult.INVALID_X
    return MissionResult.INVALID_Y if abs(item.longitude) > MAX_LONGITUDE else None


def from_message(message: m.MissionItem | m.MissionItemInt) -> MissionItem:
    """The item of either message. Floats that are no int32 become NOWHERE."""
    if isinstance(message, m.MissionItem):
        scale = DEGREES_SCALE if message.frame in GLOBAL_FRAMES else LOCAL_SCALE
        x, y = to_int32(message.x, scale), to_int32(message.y, scale)
    else:
        x, y = message.x, message.y
    return MissionItem(
        command=message.command,
        frame=message.frame,
        params=(message.param1, message.param2, message.param3, message.param4),
        x=x,
        y=y,
        z=message.z,
        autocontinue=bool(message.autocontinue),
    )


def to_int32(value: float, scale: float) -> int:
    """`value` times `scale` as an int32; NOWHERE for what is none."""
    number = value * scale
    return (
        round(number) if -UNSET_COORDINATE - 1 <= number <= UNSET_COORDINATE else UNSET_COORDINATE
    )  # NaN is not less than anything


def to_message(
    item: MissionItem, sequence: int, kind: int, target: tuple[int, int], *, current: bool = False
) -> m.MissionItemInt:
    """MISSION_ITEM_INT for item number `sequence` of the plan `kind`, to system and component `target`."""
    return m.MissionItemInt(
        *target,
        sequence,
        item.frame,
        item.command,
        int(current),
        int(item.autocontinue),
        *item.params,
        item.x,
        item.y,
        item.z,
        kind,
    )
