"""A plan as files hold it, and as a vehicle does.

Home is no item here, and DO_JUMP names its target by the index in `mission`, from 0. ArduPilot keeps home as item 0.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec
from msgspec.structs import replace

from dialects.command_places import PLACELESS
from dialects.enums import Autopilot, Command, FenceItem, MissionType
from link.services.mission.items import DEGREES_SCALE, FRAME_MISSION, Items, MissionItem, to_int32
from link.services.param.float32 import shortest_float32

GLOBAL = 0
"""MAV_FRAME_GLOBAL."""


_KINDS = (MissionType.MISSION, MissionType.FENCE, MissionType.RALLY)
_FENCE_COMMANDS = frozenset(FenceItem) - {FenceItem.RALLY_POINT}


class PlannedHome(msgspec.Struct, frozen=True):
    """A planned home position."""

    latitude: float
    """Degrees."""
    longitude: float
    altitude: float
    """m above sea level."""


class Plan(msgspec.Struct, frozen=True):
    """Mission, fence and rally points."""

    mission: Items = ()
    fence: Items = ()
    rally: Items = ()
    home: PlannedHome | None = None
    settings: Mapping[str, Any] = msgspec.field(default_factory=dict)
    """Fields of a .plan's mission that only QGroundControl uses, such as cruiseSpeed."""

    def of(self, kind: MissionType) -> Items:
        """Return one of the three."""
        return {MissionType.MISSION: self.mission, MissionType.FENCE: self.fence, MissionType.RALLY: self.rally}[kind]

    @property
    def kinds(self) -> tuple[MissionType, ...]:
        """Those of the three that have items."""
        return tuple(kind for kind in _KINDS if self.of(kind))


def kind_of(command: int) -> MissionType:
    """Return what an item belongs to by its command, whatever list it stands in."""
    if command in _FENCE_COMMANDS:
        return MissionType.FENCE
    return MissionType.RALLY if command == FenceItem.RALLY_POINT else MissionType.MISSION


def keeps_home(autopilot: int) -> bool:
    """Return whether item 0 of a mission on this autopilot is home."""
    return autopilot == Autopilot.ARDUPILOT


def for_vehicle(plan: Plan, kind: MissionType, autopilot: int) -> Items:
    """Return the items to upload.

    A command without a place goes in MAV_FRAME_MISSION: PX4 refuses it in another frame, which ArduPilot's files have.
    """
    if kind is not MissionType.MISSION:
        return plan.of(kind)
    items = tuple(replace(item, frame=FRAME_MISSION) if item.command in PLACELESS else item for item in plan.mission)
    if not keeps_home(autopilot) or not items:
        return items
    return (home_item(plan.home), *move_jumps(items, 1))


def from_vehicle(items: Items, kind: MissionType, autopilot: int) -> Plan:
    """Return the plan with the items of one type, as downloaded."""
    if kind is MissionType.FENCE:
        return Plan(fence=items)
    if kind is MissionType.RALLY:
        return Plan(rally=items)
    if not keeps_home(autopilot) or not items:
        return Plan(mission=items)
    return Plan(mission=move_jumps(items[1:], -1), home=as_home(items[0]))


def home_item(home: PlannedHome | None) -> MissionItem:
    """Return home as an item; ArduPilot replaces a home that is not known (0, 0) by its own."""
    place = home or PlannedHome(0.0, 0.0, 0.0)
    x, y = to_int32(place.latitude, DEGREES_SCALE), to_int32(place.longitude, DEGREES_SCALE)
    return MissionItem(Command.NAV_WAYPOINT, GLOBAL, (0.0, 0.0, 0.0, 0.0), x, y, place.altitude)


def as_home(item: MissionItem) -> PlannedHome | None:
    """Return an item's position as home; None for 0, 0."""
    return PlannedHome(item.latitude, item.longitude, shortest_float32(item.z)) if (item.x, item.y) != (0, 0) else None


def looks_like_home(item: MissionItem) -> bool:
    """Return whether a first item is home as Mission Planner and QGroundControl write it: in MAV_FRAME_GLOBAL."""
    return item.command == Command.NAV_WAYPOINT and item.frame == GLOBAL


def move_jumps(items: Items, by: int) -> Items:
    """Return the items with the targets of DO_JUMP moved."""
    return tuple(_move_jump(item, by) if item.command == Command.DO_JUMP else item for item in items)


def _move_jump(item: MissionItem, by: int) -> MissionItem:
    target, *others = item.params
    one, two, three = others
    return replace(item, params=(target + by, one, two, three))
