"""One item of a mission, fence or rally plan: conversion from and to messages, and validation."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from enum import Enum, IntEnum

import msgspec

from dialects import messages as m
from dialects.command_places import PLACELESS
from dialects.enums import MissionResult, MissionType

DEGREES_SCALE = 1e7
"""Degrees x this are `x` and `y` of MISSION_ITEM_INT in global frames."""
LOCAL_SCALE = 1e4
"""Metres x this are `x` and `y` in local frames."""
UNSET_COORDINATE = 0x7FFF_FFFF
"""INT32_MAX: stands for NaN."""
GLOBAL_FRAMES = frozenset({0, 3, 5, 6, 10, 11})
"""MAV_FRAME with latitude and longitude: GLOBAL, _RELATIVE_ALT, _TERRAIN_ALT and their _INT variants."""
FRAME_MISSION = 2
"""MAV_FRAME_MISSION: the item has no position."""
MAX_LATITUDE, MAX_LONGITUDE = 90.0, 180.0
_FAULTS = {
    1: MissionResult.INVALID_PARAM1,
    2: MissionResult.INVALID_PARAM2,
    3: MissionResult.INVALID_PARAM3,
    4: MissionResult.INVALID_PARAM4,
    7: MissionResult.INVALID_PARAM7,
}


class MissionItem(msgspec.Struct, frozen=True):
    """One item, from either message. Its number is its index in the plan."""

    command: int
    """MAV_CMD."""
    frame: int
    """MAV_FRAME."""
    params: tuple[float, float, float, float]
    """Parameters 1..4; NaN: the vehicle's default."""
    x: int
    """Latitude in 1e-7 degrees, or north in 1e-4 m, by frame; parameter 5 of a command without a place."""
    y: int
    z: float
    """Altitude, m."""
    autocontinue: bool = True

    @property
    def latitude(self) -> float:
        """Degrees, in a global frame."""
        return self.x / DEGREES_SCALE

    @property
    def longitude(self) -> float:
        """Degrees, in a global frame."""
        return self.y / DEGREES_SCALE


Items = tuple[MissionItem, ...]
"""A plan."""


class ItemRequest(IntEnum):
    """`current` of MISSION_ITEM(_INT) that is not part of a plan but a request, an extension of ArduPilot.

    DroneKit's simple_goto, Mission Planner and older scripts send it. MAVLink itself knows 0 and 1 only.
    """

    DRIVE_TO = 2
    """Drive to the position now, in GUIDED."""
    CHANGE_ALTITUDE = 3
    """Change the altitude of the present target."""


class PositionRule(Enum):
    """How a command uses latitude and longitude."""

    NONE = 0
    """Ignored, as is the frame."""
    OPTIONAL = 1
    """0/0 or NaN means the current position."""
    NEEDED = 2
    """Required; 0/0 is not a position."""


class ItemRule(msgspec.Struct, frozen=True):
    """What an item of one command must be."""

    place: PositionRule = PositionRule.NONE
    ranges: Mapping[int, tuple[float, float]] = msgspec.field(default_factory=dict)
    """Parameter 1..4 or 7 -> smallest and largest value. A parameter in the table must be a number, others may be
    NaN."""


class PlanRules(msgspec.Struct, frozen=True):
    """What one type of plan may contain."""

    commands: Mapping[int, ItemRule]
    """The known commands; others are UNSUPPORTED."""
    capacity: int = 500
    frames: frozenset[int] = GLOBAL_FRAMES
    check: Callable[[Items], MissionResult] = lambda items: MissionResult.ACCEPTED
    """Validates the plan as a whole: jump targets, polygons with at least three corners."""

    def validate(self, items: Sequence[MissionItem]) -> MissionResult:
        """Return ACCEPTED, or what is wrong with a whole plan."""
        if len(items) > self.capacity:
            return MissionResult.NO_SPACE
        wrong = self.first_invalid(items)
        fault = None if wrong is None else item_fault(wrong[1], self.commands, self.frames)
        return self.check(tuple(items)) if fault is None else fault

    def first_invalid(self, items: Sequence[MissionItem]) -> tuple[int, MissionItem] | None:
        """Return the first item that is invalid by itself, and its number."""
        return next((each for each in enumerate(items) if item_fault(each[1], self.commands, self.frames)), None)


def item_fault(
    item: MissionItem, rules: Mapping[int, ItemRule], frames: frozenset[int] = GLOBAL_FRAMES
) -> MissionResult | None:
    """Return why an item is invalid, or None. `rules`: the known commands; `frames`: the supported frames."""
    rule = rules.get(item.command)
    if rule is None:
        return MissionResult.UNSUPPORTED
    if item.frame not in frames and not (rule.place is PositionRule.NONE and item.frame == FRAME_MISSION):
        return MissionResult.UNSUPPORTED_FRAME
    return _bad_parameter(item, rule) or (_bad_place(item, rule.place) if item.frame in GLOBAL_FRAMES else None)


def describe_rejection(wrong: tuple[int, MissionItem] | None, verdict: MissionResult) -> str:
    """Return what is wrong with a plan: one item, with its number, or the plan as a whole."""
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


def item_request(message: m.MissionItem | m.MissionItemInt) -> ItemRequest | None:
    """Return what an item requests, or None if it is a part of a plan."""
    if message.mission_type != MissionType.MISSION:
        return None
    return next((request for request in ItemRequest if request == message.current), None)


def from_message(message: m.MissionItem | m.MissionItemInt) -> MissionItem:
    """Return the item of either message. Floats beyond int32 become UNSET_COORDINATE."""
    if isinstance(message, m.MissionItem):
        scale = coordinate_scale(message.command, message.frame)
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


def coordinate_scale(command: int, frame: int) -> float:
    """Return what a degree, a metre or a plain parameter 5 or 6 is multiplied by to give `x` and `y`.

    The command decides first: a parameter that is not a place stays as it is in each frame
    (https://mavlink.io/en/services/mission.html#frames_mission_items).
    """
    if frame == FRAME_MISSION or command in PLACELESS:
        return 1
    return DEGREES_SCALE if frame in GLOBAL_FRAMES else LOCAL_SCALE


def to_int32(value: float, scale: float) -> int:
    """Return `value` times `scale` as an int32; UNSET_COORDINATE if it does not fit."""
    number = value * scale
    return round(number) if -UNSET_COORDINATE - 1 <= number <= UNSET_COORDINATE else UNSET_COORDINATE  # false for NaN


def to_message(
    item: MissionItem, sequence: int, kind: int, target: tuple[int, int], *, current: bool = False
) -> m.MissionItemInt:
    """Return MISSION_ITEM_INT for item `sequence` of the plan `kind`, to `target` (system, component)."""
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
