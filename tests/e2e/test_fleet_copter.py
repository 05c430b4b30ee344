"""A copter in a fleet whose ground station is killed: the watchdog has no way through the router.

The last demand goes on for RC_OVERRIDE_TIME of the copter, then its own failsafe flies it: as after a cut link.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from dialects.axes import HOVER
from tests.e2e.fleet_programs import RouterProcess, make_fleet
from tests.fakes.multicopters import ArduCopter
from tests.groundstation.watchdog.test_killed_in_the_air import LOSS, Flight
from tests.waits import wait_until

pytestmark = [pytest.mark.slow, pytest.mark.e2e]

KEPT, RADIO, BRAKES = 3.0, 0.5, 4.0
"""s: RC_OVERRIDE_TIME, the radio failsafe after it, and what the stand-in takes to brake."""
LATE = 2.0
"""s that a machine under load may add."""


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as opened:
        yield opened


def test_a_killed_station_leaves_a_copter_to_its_own_failsafe(tmp_path: Path, stack: ExitStack) -> None:
    fleet = make_fleet(tmp_path, rover1="vehicle", alice="drive")
    RouterProcess(fleet, stack)

    def join(copter: str) -> str:
        line = [sys.executable, "-m", "link.bridge", copter, f"zenoh:{fleet}/rover1.json5/farm/rover1"]
        bridge = subprocess.Popen(line, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        stack.callback(bridge.wait)
        stack.callback(bridge.kill)
        return f"zenoh:{fleet}/alice.json5/farm"

    flight = Flight(ArduCopter(), "udpin", stack, join)
    copter, altitude, lowest = flight.copter, flight.copter.altitude, [flight.copter.altitude]
    at = time.monotonic()
    os.kill(flight.station, signal.SIGKILL)

    def acted() -> bool:
        lowest.append(copter.altitude)
        return copter.mode_name in ("RTL", "LAND")

    wait_until(acted)
    assert time.monotonic() - at < KEPT + RADIO + LATE
    assert min(lowest) > altitude - LOSS

    def told() -> bool:
        flight.screen.client.receive()
        return "neutral could NOT be sent" in flight.screen.client.outage.text

    wait_until(told, lambda: flight.screen.client.outage.text)
    assert copter.lowest_z >= HOVER
    assert copter.armed
    wait_until(lambda: not copter.armed)
    assert copter.hit_ground_at < 1.0
