"""Quitting: what this station armed is disarmed, or named as left armed."""

from __future__ import annotations

from itertools import pairwise

import pytest

from dialects.enums import Command
from dialects.modes import Mode
from groundstation.intents.session import Quit
from groundstation.station.driving.stops.shutdown import DISARM_AFTER, DISARM_TIMEOUT
from tests.fakes.rover import FakeArduPilot
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import Cockpit, armed_cockpit, cockpit_with, driving_cockpit

ARM = Command.COMPONENT_ARM_DISARM


def left(cockpit: Cockpit) -> tuple[str, ...]:
    return cockpit.snapshot.left_armed


@pytest.mark.parametrize("make", [FakeVehicle, FakeArduPilot])
def test_quitting_disarms_what_this_station_armed_after_neutral(make: type[FakeVehicle]) -> None:
    cockpit = driving_cockpit(make())
    vehicle, start = cockpit.vehicle, cockpit.now
    cockpit.do(Quit(disarm=True))
    cockpit.run(DISARM_AFTER - 0.1)
    assert vehicle.armed
    assert not cockpit.station.finished
    times = sorted({at for at, *_ in cockpit.demands(start + 0.001)})
    assert sum(later - earlier > 0.02 for earlier, later in pairwise(times)) == 4, "five neutral ones first, and a copy"
    cockpit.run(0.5)
    assert not vehicle.armed
    assert cockpit.station.finished
    assert left(cockpit) == ()


@pytest.mark.parametrize("after", [0.0, 1.0])
def test_a_second_quit_leaves_it_armed(after: float) -> None:
    cockpit = driving_cockpit()
    cockpit.do(Quit(disarm=True))
    cockpit.run(after)
    cockpit.do(Quit())
    cockpit.run(0.5)
    assert cockpit.station.finished
    cockpit.run(5.0)
    assert cockpit.vehicle.armed
    assert left(cockpit) == ("Rover 1 is left ARMED in MANUAL",)


def test_a_plain_quit_leaves_it_armed_and_says_so() -> None:
    cockpit = driving_cockpit()
    cockpit.do(Quit())
    cockpit.run(5.0)
    assert cockpit.station.finished
    assert cockpit.vehicle.armed
    assert left(cockpit) == ("Rover 1 is left ARMED in MANUAL",)


def test_without_an_answer_it_says_that_it_is_left_armed() -> None:
    cockpit = armed_cockpit()
    cockpit.world.cut()
    cockpit.do(Quit(disarm=True))
    cockpit.run(DISARM_AFTER + DISARM_TIMEOUT - 0.1)
    assert not cockpit.station.finished
    cockpit.run(0.2)
    assert cockpit.station.finished
    assert left(cockpit) == ("Rover 1 is left ARMED in MANUAL (no heartbeat for 4 s)",)


def test_a_vehicle_that_drives_itself_is_left_alone_and_named() -> None:
    cockpit = armed_cockpit()
    cockpit.vehicle.mode = Mode.AUTO
    cockpit.run(1.2)
    cockpit.do(Quit(disarm=True))
    cockpit.run(5.0)
    assert cockpit.vehicle.armed
    assert left(cockpit) == ("Rover 1 is left ARMED in AUTO",)


def test_a_vehicle_driven_or_armed_by_another_is_left_alone() -> None:
    taken = armed_cockpit()
    taken.vehicle.driver = 254
    foreign = cockpit_with(FakeArduPilot())
    foreign.vehicle.armed = True
    for cockpit in (taken, foreign):
        cockpit.run(1.5)
        before = len(cockpit.vehicle.commands(ARM))
        cockpit.do(Quit(disarm=True))
        cockpit.run(5.0)
        assert len(cockpit.vehicle.commands(ARM)) == before
        assert cockpit.vehicle.armed
    assert left(foreign) == ()


def test_with_nothing_armed_it_is_finished_at_once() -> None:
    cockpit = cockpit_with(FakeVehicle())
    cockpit.do(Quit(disarm=True))
    assert cockpit.station.finished
    assert left(cockpit) == ()
