"""A motor test with the real programs: the wheel turns while its key is held, and stops whatever ends the test."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable

import pytest

from tests.e2e.conftest import Rig
from tests.e2e.programs import GroundStation
from tests.e2e.test_station_process_lost import shows, station_of
from tests.waits import PATIENCE

pytestmark = pytest.mark.e2e

F6, F8 = "\x1b[17~", "\x1b[19~"
GONE_WITHIN = 0.5
"""s for which a wheel may turn after the station is gone (docs/safety.md)."""
MARGIN = 0.2
"""s for a loop and a frame of each program."""


def begin(program: GroundStation) -> None:
    """Open the Setup screen and answer its question."""
    program.screen = b""
    program.type(F8)
    shows(program, "doctor: why can I not drive")
    program.wait_for(lambda: "left wheel" in program.drawn(), PATIENCE, "the motors")
    program.type("m")
    shows(program, "WHEELS OFF THE GROUND")
    program.type("y")
    shows(program, "hold a key")


def stopped_after(world: Rig, since: float) -> float:
    """Return how long after `since` the wheels got no power any more."""
    world.station.wait_for(world.vehicle.stands, PATIENCE, "the wheel stands")
    return max(output.at for output in world.vehicle.outputs()) - since


def test_wheel_turns_while_its_key_is_held_and_stops_with_rest(rig: Callable[..., Rig]) -> None:
    world = rig()
    program, vehicle = world.station, world.vehicle
    program.wait_for(lambda: b"DISARMED" in program.screen, PATIENCE, "a vehicle")
    begin(program)

    program.press_until("1", vehicle.turning)
    world.watch()
    let_go = time.monotonic()
    assert stopped_after(world, let_go) < 1.1 + MARGIN + world.asking.total(), "the key is released"

    program.look(1.2)
    program.press_until("2", vehicle.turning)
    world.watch()
    switched = time.monotonic()
    program.type(F6)
    assert stopped_after(world, switched) < MARGIN + world.asking.total(), "another screen"

    begin(program)
    program.press_until("1", vehicle.turning)
    station = station_of(program)
    world.watch()
    killed = time.monotonic()
    os.kill(station, signal.SIGKILL)
    assert stopped_after(world, killed) < GONE_WITHIN + MARGIN + world.obeying.total(), "the station is killed"
    assert max(map(abs, (value for output in vehicle.outputs() for value in output.throttles))) < 0.13
