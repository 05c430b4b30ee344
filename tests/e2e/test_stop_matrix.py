"""The stop matrix: real programs, and every way in which a driver can vanish. Wheels turn first, then they stop.

The bounds of docs/safety.md (outputs begin to fall within 0.5 s of the last valid demand, and are neutral within 1 s)
are held to the millisecond in virtual time by tests/test_stops.py. Here a shared machine with two cores may be late
itself: NOISE is what we grant it.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable

import pytest

from dialects.modes import Mode
from tests.e2e.conftest import Rig
from tests.e2e.programs import REPEAT, drive

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(180)]

FALLS_WITHIN = 0.5
NEUTRAL_WITHIN = 1.0
NOISE = 0.4
HOLD_TIMEOUT = 0.25
"""s after the last auto-repeat at which a held key counts as let go (groundstation/sticks.py, over ssh)."""

Build = Callable[..., Rig]


def assert_stops(rig: Rig, *, from_last_demand: bool = True) -> None:
    """The wheels, turning until now, stop in time and stay still."""
    rig.relay.wait(lambda: not rig.vehicle.turning(), NEUTRAL_WITHIN + HOLD_TIMEOUT + 2, "the wheels stop")
    if from_last_demand:
        falls, stops = rig.vehicle.falls_and_stops_after(rig.relay.last_demand())
        assert falls <= FALLS_WITHIN + NOISE
        assert stops <= NEUTRAL_WITHIN + NOISE
    stopped = time.monotonic()
    rig.relay.wait(lambda: time.monotonic() > stopped + 1.5, 3, "a while passes")
    assert not rig.vehicle.moved_since(stopped)


def test_key_released(rig: Build) -> None:
    world = rig()
    drive(world.station, world.vehicle, world.relay)
    released = time.monotonic()
    assert_stops(world)
    assert world.vehicle.outputs()[-1].at - released <= HOLD_TIMEOUT + NEUTRAL_WITHIN + NOISE
    assert world.relay.armed()


@pytest.mark.parametrize("burst", ["ik", "ki", "iiiii ", " i", "lk", "ik\x1b[A"])
def test_a_stop_key_in_a_burst_wins(rig: Build, burst: str) -> None:
    world = rig()
    drive(world.station, world.vehicle, world.relay)
    pressed = time.monotonic()
    world.station.type(burst)
    assert_stops(world)
    assert world.vehicle.outputs()[-1].at - pressed <= NEUTRAL_WITHIN + NOISE


def test_terminal_closed(rig: Build) -> None:
    world = rig()
    drive(world.station, world.vehicle, world.relay)
    closed = time.monotonic()
    world.station.close_terminal()
    assert_stops(world)
    assert world.station.process.wait(10) is not None
    assert world.relay.neutral_since(closed) >= 3


def test_ground_station_killed(rig: Build) -> None:
    world = rig()
    drive(world.station, world.vehicle, world.relay)
    os.kill(world.station.process.pid, signal.SIGKILL)
    assert_stops(world)


def test_ground_station_and_its_children_killed(rig: Build) -> None:
    world = rig()
    drive(world.station, world.vehicle, world.relay)
    os.killpg(world.station.process.pid, signal.SIGKILL)
    assert_stops(world)


def test_ground_station_frozen(rig: Build) -> None:
    """Only the screen's process hangs: the station notices that its lease is not renewed."""
    world = rig()
    drive(world.station, world.vehicle, world.relay)
    os.kill(world.station.process.pid, signal.SIGSTOP)
    assert_stops(world)
    assert world.relay.newest_demand_is_neutral()


def test_ground_station_frozen_with_its_children(rig: Build) -> None:
    world = rig()
    drive(world.station, world.vehicle, world.relay)
    os.killpg(world.station.process.pid, signal.SIGSTOP)
    assert_stops(world)
    os.killpg(world.station.process.pid, signal.SIGCONT)
    back = time.monotonic()
    world.relay.wait(lambda: time.monotonic() > back + 1.0, 3, "a while passes")
    assert not world.vehicle.moved_since(back)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_ground_station_told_to_end(rig: Build, number: signal.Signals) -> None:
    world = rig()
    drive(world.station, world.vehicle, world.relay)
    told = time.monotonic()
    os.kill(world.station.process.pid, number)
    assert_stops(world)
    assert world.station.ended() == 128 + number  # as shells count
    assert world.relay.neutral_since(told) >= 3


def test_quit_by_key(rig: Build) -> None:
    world = rig()
    drive(world.station, world.vehicle, world.relay)
    told = time.monotonic()
    world.station.type("\x03")
    assert_stops(world)
    assert world.station.ended() == 0
    assert world.relay.neutral_since(told) >= 3


def test_link_cut_and_back_with_the_key_held_all_along(rig: Build) -> None:
    """After 10 s without a link nothing moves by itself: not on the old demand, not on the key that is still held."""
    world = rig()
    drive(world.station, world.vehicle, world.relay)
    world.relay.cut()
    cut = time.monotonic()
    world.station.hold("i", lambda: time.monotonic() > cut + 10.0)
    falls, stops = world.vehicle.falls_and_stops_after(world.relay.last_demand())
    assert falls <= FALLS_WITHIN + NOISE
    assert stops <= NEUTRAL_WITHIN + NOISE
    world.relay.cut(False)
    back = time.monotonic()
    world.station.hold("i", lambda: time.monotonic() > back + 3.0)
    assert world.relay.demands_since(back + 1.0)  # the station is heard again, and asks for motion
    assert not world.vehicle.moved_since(cut + NEUTRAL_WITHIN + NOISE)
    world.station.look(1.0)  # the key is let go
    world.station.type("1")  # MANUAL, because the vehicle went to HOLD
    world.station.wait_for(lambda: world.relay.mode() == Mode.MANUAL, 5, "MANUAL again")
    world.station.hold("i", world.vehicle.at_full)


@pytest.mark.parametrize(("loss", "keeps_driving"), [(0.10, True), (0.30, False)])
def test_a_lossy_minute(rig: Build, loss: float, keeps_driving: bool) -> None:
    """One minute of holding and letting go. Motion follows the keys or ends; it never comes late."""
    world = rig(loss=loss, delay=0.010)
    drive(world.station, world.vehicle, world.relay)
    start = time.monotonic()
    drove = 0
    while time.monotonic() < start + 60:
        if world.relay.mode() != Mode.MANUAL:
            world.station.type("1")
        pressed = time.monotonic()
        world.station.hold("i", lambda pressed=pressed: time.monotonic() > pressed + 5.0)  # type: ignore[misc]
        drove += world.vehicle.at_full()
        released = time.monotonic()
        world.station.look(HOLD_TIMEOUT + NEUTRAL_WITHIN + NOISE)
        assert not world.vehicle.moved_since(released + HOLD_TIMEOUT + NEUTRAL_WITHIN + NOISE - REPEAT)
        assert not world.vehicle.turning()
    if keeps_driving:
        assert drove >= 8


def test_vehicle_told_to_end(rig: Build) -> None:
    world = rig()
    drive(world.station, world.vehicle, world.relay)
    world.vehicle.process.send_signal(signal.SIGTERM)
    assert world.vehicle.process.wait(5) == 0
    assert not world.vehicle.turning()
    lines = world.vehicle.errors.read_text().splitlines()
    assert lines[-1] == "vehicle: stopped by SIGTERM, motors neutral"
    assert all(line.startswith("vehicle: ") for line in lines)
