"""Missions of vehicles that behave as ArduPilot and as PX4 do, through the station process and real sockets."""

from __future__ import annotations

import contextlib
import math
import select
import time
from collections.abc import Callable, Iterator

import pytest

from groundstation.client import StationClient
from groundstation.intents.plan import GoTo, JumpToItem, PauseMission, SetHome, StartMission, UploadPlan
from groundstation.intents.session import RenewLease
from groundstation.intents.union import AnyIntent
from groundstation.intents.watch import Watch
from groundstation.ui.map.plan.copies import PlanCopies
from groundstation.views.plan import PlanKind
from groundstation.views.requests import RequestLine
from tests.fakes.services import ARDUPILOT, PX4, ForeignVehicle, foreign_vehicle
from tests.groundstation.ui.map.plans import HOME, at, item, task
from tests.waits import PATIENCE

ITEMS = (item(16, 5), item(19, 5, 5, 3.0), task(177, 0.0, 2.0))


class Station:
    """A station process, and the copies of a Map screen."""

    def __init__(self, endpoint: str) -> None:
        self.client = StationClient.start([endpoint])
        self.copies = PlanCopies()
        self._watched: object = None
        self._number = 0

    def until(self, condition: Callable[[], bool]) -> None:
        """Handle views until it is true."""
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < deadline
            self.client.send(RenewLease())
            if self._watched != self.copies.requests:
                self._watched = self.copies.requests
                self.client.send(Watch(self.copies.requests))
            select.select(self.client.filenos(), [], [], 0.05)
            self.client.receive()
            for view in self.client.pop_views():
                self.copies.show_view(view)

    def number(self) -> int:
        self._number += 1
        return self._number

    def ask(self, intent: AnyIntent) -> RequestLine:
        """Send a request; return how it ended."""
        self.client.send(RenewLease(), intent)
        self.until(lambda: self._ended() is not None)
        ended = self._ended()
        assert ended is not None
        return ended

    def _ended(self) -> RequestLine | None:
        view = self.copies.view
        return next((each for each in view.ended if each.number == self._number), None) if view is not None else None


@contextlib.contextmanager
def open_station(endpoint: str) -> Iterator[Station]:
    """A station that has found its vehicle."""
    made = Station(endpoint)
    try:
        made.until(lambda: made.copies.view is not None)
        yield made
    finally:
        made.client.close()


@pytest.fixture(params=[ARDUPILOT, PX4], ids=["ardupilot", "px4"])
def vehicle(request: pytest.FixtureRequest) -> Iterator[ForeignVehicle]:
    with foreign_vehicle(request.param) as made:
        yield made


def test_plans_and_missions(vehicle: ForeignVehicle) -> None:
    with open_station(vehicle.endpoint) as station:
        check_plans(station, vehicle, ardupilot=vehicle.autopilot == ARDUPILOT)


def check_plans(station: Station, vehicle: ForeignVehicle, *, ardupilot: bool) -> None:
    upload = UploadPlan(station.number(), 1, 0, ITEMS, HOME, 584.0)
    assert station.ask(upload).state == "accepted"
    there = vehicle.missions.items[0]
    assert len(there) == (4 if ardupilot else 3)
    assert there[-1].param1 == (1 if ardupilot else 0), "the jump has the number that the vehicle gives the item"
    if ardupilot:
        assert (there[0].frame, there[0].x, there[0].z) == (0, -353632621, 584.0), "item 0 is home"
    station.until(lambda: PlanKind.MISSION in station.copies.items)
    assert station.copies.items[PlanKind.MISSION] == ITEMS
    assert station.copies.view is not None
    assert station.copies.view.first == (1 if ardupilot else 0)

    vehicle.missions.refuse = {2: 10}
    refused = station.ask(UploadPlan(station.number(), 1, 0, (*ITEMS, item(16, 9)), HOME))
    assert (refused.state, refused.detail) == ("refused", "item 2: INVALID_PARAM5_X")
    assert vehicle.missions.items[0] is there, "the old plan stays"

    assert station.ask(JumpToItem(station.number(), 1, 1)).state == "accepted"
    assert station.ask(StartMission(station.number(), 1)).state == "accepted"
    assert station.ask(PauseMission(station.number(), 1)).state == "accepted"
    sent = vehicle.of("COMMAND_LONG")
    assert [each.param1 for each in sent if each.command == 224] == [2.0 if ardupilot else 1.0]
    modes = [(each.param2, each.param3) for each in sent if each.command == 176]
    assert modes == ([(10, 0), (4, 0)] if ardupilot else [(4, 4), (4, 3)])

    assert station.ask(GoTo(station.number(), 1, at(7, 8))).state == "accepted"
    [go] = vehicle.of("COMMAND_INT")
    assert (go.command, go.param1, go.param2, go.x) == (192, -1.0, 1.0, round(at(7, 8).latitude * 1e7))
    assert (go.frame, math.isnan(go.z)) == ((3, False) if ardupilot else (0, True))
    home = station.ask(SetHome(station.number(), 1, at(1, 1)))
    assert (home.state, home.detail) == ("refused", "the altitude of home is not known yet")
