"""Plans for tests: items, upload and run as a ground station does it, in a simulated field."""

from __future__ import annotations

from itertools import groupby

from dialects import messages as m
from dialects.enums import Command, MissionResult, MissionType, Result
from dialects.modes import Mode
from tests.vehicle.bench import DRIVER
from tests.vehicle.field import GROUND, Field
from vehicle.navigation.geo import Point

Item = tuple[int, Point | None, tuple[float, ...]]


def way(north: float, east: float, hold: float = 0.0) -> Item:
    return Command.NAV_WAYPOINT, Point(north, east), (hold,)


def do(command: int, *params: float) -> Item:
    return command, None, params


def upload(field: Field, *items: Item, kind: MissionType = MissionType.MISSION, system: int = DRIVER) -> int:
    """Upload as a ground station does; return the result of MISSION_ACK."""
    before = len(field.all(m.MissionAck))
    send(field, *items, kind=kind, system=system)
    return int(field.all(m.MissionAck)[before].type)


def send(field: Field, *items: Item, kind: MissionType = MissionType.MISSION, system: int = DRIVER) -> None:
    """Upload without checking the answer."""
    before = len(field.all(m.MissionAck))
    field.say(m.MissionCount(1, 1, len(items), kind), system)
    if len(field.all(m.MissionAck)) > before:  # refused, or an empty one
        return
    for number, (command, place, params) in enumerate(items):
        latitude, longitude = GROUND.to_global(place) if place else (0.0, 0.0)
        one, two, three, four = (*params, *(0.0,) * (4 - len(params)))
        x, y = round(latitude * 1e7), round(longitude * 1e7)
        frame = 6 if place else 2
        field.say(m.MissionItemInt(1, 1, number, frame, command, 0, 1, one, two, three, four, x, y, 0, kind), system)


def ready(*items: Item, **params: float) -> Field:
    field = Field(**params)  # type: ignore[arg-type]
    assert upload(field, *items) == MissionResult.ACCEPTED
    assert field.arm() is Result.ACCEPTED
    return field


def passed(field: Field) -> list[int]:
    """Return the items in the order in which they were reached; each message is repeated."""
    return [index for index, _ in groupby(each.seq for each in field.all(m.MissionItemReached))]


def start(field: Field) -> None:
    assert field.command(Command.MISSION_START) is Result.ACCEPTED, field.texts


def finish(field: Field, within: float) -> None:
    end = field.now + within
    while field.mode is not Mode.HOLD:
        assert field.now < end, f"at {field.truth}; {field.texts}"
        field.heartbeat()
        field.wait(0.5)
