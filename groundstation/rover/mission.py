"""Mission, Fence and Rally: the plans of a vehicle as values, and as files of QGroundControl and Mission Planner."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import ClassVar, Self

import msgspec

from dialects.enums import Autopilot, Command, MissionType
from groundstation.formats.errors import FileFormatError
from groundstation.formats.plan import from_vehicle
from groundstation.formats.plan_of_name import format_named, parse_named
from groundstation.rover.errors import InvalidCall
from link.services.mission.items import DEGREES_SCALE, Items, MissionItem, to_int32

RELATIVE = 3
"""MAV_FRAME_GLOBAL_RELATIVE_ALT."""
HIGHEST_LATITUDE, HIGHEST_LONGITUDE = 90.0, 180.0
"""Degrees."""


class PlanItems(msgspec.Struct, frozen=True):
    """What the three kinds have in common: items in the order of the vehicle, without home."""

    verb: ClassVar[str]
    """The verb that takes such a file."""
    kind: ClassVar[MissionType]
    items: Items = ()

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Return what a .plan or .waypoints file has of this kind. Raises InvalidCall, OSError."""
        name = os.fspath(path)
        with open(name, encoding="utf-8") as file:
            try:
                plan = parse_named(file.read(), name)
            except FileFormatError as error:
                raise InvalidCall(str(error)) from None
            except UnicodeDecodeError:
                raise InvalidCall(f"{name}: not a text file") from None
        if not plan.of(cls.kind):
            raise InvalidCall(f"{name}: no {cls.verb} in it")
        return cls(plan.of(cls.kind))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a .plan or .waypoints file, which is replaced. Raises InvalidCall, OSError."""
        name = os.fspath(path)
        try:
            text = format_named(from_vehicle(self.items, self.kind, Autopilot.GENERIC), name)
        except FileFormatError as error:
            raise InvalidCall(f"{name}: {error}") from None
        with open(name, "w", encoding="utf-8") as file:
            file.write(text)


class Mission(PlanItems, frozen=True):
    """A mission. DO_JUMP names its target by the index in `items`, from 0."""

    verb = "mission"
    kind = MissionType.MISSION

    @classmethod
    def through(cls, places: Iterable[tuple[float, float]]) -> Self:
        """Return a mission of waypoints. `places`: latitude and longitude, degrees. Raises InvalidCall."""
        return cls(tuple(_waypoint(*place) for place in places))


class Fence(PlanItems, frozen=True):
    """The polygons and circles of a fence."""

    verb = "fence"
    kind = MissionType.FENCE


class Rally(PlanItems, frozen=True):
    """Rally points."""

    verb = "rally"
    kind = MissionType.RALLY


def _waypoint(latitude: float, longitude: float) -> MissionItem:
    if not (abs(latitude) <= HIGHEST_LATITUDE and abs(longitude) <= HIGHEST_LONGITUDE):
        raise InvalidCall(f"{latitude!r}, {longitude!r} is not a place: latitude -90 to 90, longitude -180 to 180")
    x, y = to_int32(latitude, DEGREES_SCALE), to_int32(longitude, DEGREES_SCALE)
    return MissionItem(Command.NAV_WAYPOINT, RELATIVE, (0.0, 0.0, 0.0, 0.0), x, y, 0.0)
