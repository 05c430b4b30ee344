"""The stop matrix over a serial cable and over TCP: wheels turn first, then they stop, and nothing moves by itself.

test_stop_matrix.py (UDP) has the stops that do not depend on the link; the bounds and NOISE are the same.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import pytest

from tests.e2e.cable import SerialCable
from tests.e2e.programs import GroundStation, Vehicle, drive, drive_on
from tests.e2e.tcp_cable import TcpCable
from tests.e2e.test_stop_matrix import FALLS_WITHIN, HOLD_TIMEOUT, NEUTRAL_WITHIN, NOISE
from tests.ports import free_port
from tests.waits import PATIENCE, Waits, wait_until

pytestmark = pytest.mark.e2e

STILL = 1.5
"""s for which stopped wheels are watched."""


class Cable(Protocol):
    """What connects the two programs."""

    def plug(self) -> None:
        """Connect them again."""

    def unplug(self) -> None:
        """Disconnect them."""

    def close(self) -> None:
        """Close the connection for good."""


@dataclass
class Rig:
    """Vehicle, cable and ground station."""

    vehicle: Vehicle
    cable: Cable
    station: GroundStation
    waits: Waits = field(init=False)
    """How long the machine delayed all of them since the wheels turned."""


def serial_rig(folder: Path, stack: ExitStack) -> Rig:
    cable = SerialCable(folder)
    stack.callback(cable.close)
    return _rig(folder, stack, cable, cable.one, cable.two)


def tcp_rig(folder: Path, stack: ExitStack) -> Rig:
    port = free_port()
    cable = TcpCable(port)
    stack.callback(cable.close)
    return _rig(folder, stack, cable, f"tcpin:127.0.0.1:{port}", f"tcpout:127.0.0.1:{cable.port}")


def _rig(folder: Path, stack: ExitStack, cable: Cable, vehicle_end: str, station_end: str) -> Rig:
    vehicle = Vehicle(folder, vehicle_end)
    stack.callback(vehicle.end)
    station = GroundStation(folder, station_end, columns=140, lines=45)  # shows more than two lines of the log
    stack.callback(station.end)
    return Rig(vehicle, cable, station)


@pytest.fixture(params=[serial_rig, tcp_rig], ids=["serial", "tcp"])
def rig(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Rig]:
    """Arm and hold `i` until the wheels turn."""
    with ExitStack() as stack:
        rig: Rig = request.param(tmp_path, stack)
        drive(rig.station, rig.vehicle, rig.station.says_armed)
        watch(rig)
        yield rig


def drive_again(rig: Rig) -> None:
    """Drive after a stop, still armed."""
    drive_on(rig.station, rig.vehicle)
    watch(rig)


def watch(rig: Rig) -> None:
    """Count the delays from now on, while the wheels turn."""
    rig.waits = Waits(rig.vehicle.process.pid, rig.station.process.pid)
    # Counting took some time; the stop must follow at once. On a busy machine the key may have to be pressed anew.
    if not rig.station.held("i", rig.vehicle.at_full, 5.0):
        drive_on(rig.station, rig.vehicle)


def assert_stops(rig: Rig, since: float, later: float = 0.0) -> None:
    """Check that the wheels stop in time after `since` (when the last demand can have arrived) and stay stopped."""
    rig.station.wait_for(rig.vehicle.stands, PATIENCE, "the wheels stop")
    noise = NOISE + rig.waits.total()
    falls, stops = rig.vehicle.falls_and_stops_after(since)
    assert falls <= FALLS_WITHIN + later + noise
    assert stops <= NEUTRAL_WITHIN + later + noise
    stopped = rig.vehicle.outputs()[-1].at
    rig.station.look(STILL)
    assert not rig.vehicle.moved_since(stopped)


def hold(rig: Rig, seconds: float) -> None:
    """Keep the key held for a time."""
    start = time.monotonic()
    rig.station.hold("i", lambda: time.monotonic() > start + seconds)


@pytest.mark.slow
def test_every_stop_of_living_programs_and_then_closed_terminal(rig: Rig) -> None:
    """One after the other with the same programs, because their start takes most of the time."""
    check_released_key(rig)
    drive_again(rig)
    check_stop_key_in_a_burst(rig)
    drive_again(rig)
    check_unplugged_and_back_with_the_key_held_all_along(rig)
    drive_again(rig)
    check_terminal_closed(rig)


def check_released_key(rig: Rig) -> None:
    assert_stops(rig, time.monotonic(), HOLD_TIMEOUT)


def check_stop_key_in_a_burst(rig: Rig) -> None:
    rig.station.type("iik")
    assert_stops(rig, time.monotonic())


def check_unplugged_and_back_with_the_key_held_all_along(rig: Rig) -> None:
    """MAN_TIMEOUT stops the rover, the driver gets a text, and after the reconnect nothing moves until neutral and a
    new press."""
    unplugged = time.monotonic()
    rig.cable.unplug()
    rig.station.hold("i", lambda: b"link lost for" in rig.station.screen)  # the driver is told
    noise = NOISE + rig.waits.total()
    falls, stops = rig.vehicle.falls_and_stops_after(unplugged)
    assert falls <= FALLS_WITHIN + noise
    assert stops <= NEUTRAL_WITHIN + noise
    stopped = time.monotonic()
    rig.cable.plug()
    start = len(rig.station.screen)
    rig.station.hold("i", lambda: b"back after" in rig.station.screen[start:])
    hold(rig, 3.0)
    assert not rig.vehicle.moved_since(stopped)


def check_terminal_closed(rig: Rig) -> None:
    rig.station.close_terminal()
    closed = time.monotonic()
    granted = 0.0

    def stand() -> bool:
        nonlocal granted
        granted = rig.waits.total()  # repeatedly, because the ground station ends meanwhile
        return rig.vehicle.stands()

    wait_until(stand)
    _, stops = rig.vehicle.falls_and_stops_after(closed)
    assert stops <= NEUTRAL_WITHIN + NOISE + granted
    assert rig.station.process.wait(PATIENCE) is not None


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_ground_station_killed_or_frozen_with_its_children(rig: Rig, number: signal.Signals) -> None:
    os.killpg(rig.station.process.pid, number)
    assert_stops(rig, time.monotonic())
