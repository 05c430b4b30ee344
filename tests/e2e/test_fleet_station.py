"""A ground station that drives through a router and is killed: the watchdog has no way to the vehicle there.

The vehicle then stops by its own rule, MAN_TIMEOUT, as after a cut link.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.e2e.fleet_driver import FALL, MAN_TIMEOUT
from tests.e2e.fleet_programs import RouterProcess, make_fleet
from tests.e2e.programs import GroundStation, Vehicle, drive
from tests.groundstation.screen import children
from tests.waits import PATIENCE, Waits

pytestmark = [pytest.mark.slow, pytest.mark.e2e]


class Driven:
    """A vehicle, a router and a ground station that drives."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        fleet = make_fleet(folder, rover1="vehicle", alice="drive")
        RouterProcess(fleet, stack)
        self.vehicle = Vehicle(folder, f"zenoh:{fleet}/rover1.json5/farm/rover1")
        stack.callback(self.vehicle.end)
        self.screen = GroundStation(folder, f"zenoh:{fleet}/alice.json5/farm")
        stack.callback(self.screen.end)
        drive(self.screen, self.vehicle, self.armed)
        [self.station] = children(self.screen.process.pid)

    def armed(self) -> bool:
        text = self.vehicle.errors.read_text()
        return text.rfind("Armed by") > text.rfind("Disarmed")


@pytest.fixture
def driven(tmp_path: Path) -> Iterator[Driven]:
    with ExitStack() as stack:
        yield Driven(tmp_path, stack)


def test_the_vehicle_stops_by_its_own_rule(driven: Driven) -> None:
    vehicle, screen, waits = driven.vehicle, driven.screen, Waits(driven.vehicle.process.pid)
    screen.press_until("i", vehicle.at_full)
    at = time.monotonic()
    os.kill(driven.station, signal.SIGKILL)
    screen.wait_for(vehicle.stands, PATIENCE, "the wheels stop")
    falls, stood = vehicle.falls_and_stops_after(at)
    assert falls <= MAN_TIMEOUT + 0.1 + waits.total()
    assert stood <= MAN_TIMEOUT + FALL + waits.total()
    screen.wait_for(lambda: "neutral could NOT be sent to rover1" in screen.drawn(), PATIENCE, "the screen says so")
