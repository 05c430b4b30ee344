"""The stop matrix over a serial cable and over TCP: wheels turn first, then they stop, and nothing moves by itself.

What is not told apart here is in test_stop_matrix.py (UDP); the bounds and NOISE are those of it.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple, Protocol

import pytest

from tests.e2e.cable import SerialCable
from tests.e2e.programs import GroundStation, Vehicle
from tests.e2e.tcp_cable import TcpCable, free_tcp_port
from tests.e2e.test_stop_matrix import FALLS_WITHIN, HOLD_TIMEOUT, NEUTRAL_WITHIN, NOISE
from tests.groundstation.screen import until

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(180)]

STILL = 1.5
"""s for which wheels that stopped are watched."""


class Cable(Protocol):
    """What joins the two programs."""

    def plug(self) -> None:
        """Join them again."""

    def unplug(self) -> None:
        """Part them."""

    def close(self) -> None:
        """End it."""


class Rig(NamedTuple):
    """Vehicle - cable - ground station."""

    vehicle: Vehicle
    cable: Cable
    station: GroundStation


def serial_rig(folder: Path, stack: ExitStack) -> Rig:
    cable = SerialCable(folder)
    stack.callback(cable.close)
    return _rig(folder, stack, cable, cable.one, cable.two)


def tcp_rig(folder: Path, stack: ExitStack) -> Rig:
    port = free_tcp_port()
    cable = TcpCable(port)
    stack.callback(cable.close)
    return _rig(folder, stack, cable, f"tcpin:127.0.0.1:{port}", f"tcpout:127.0.0.1:{cable.port}")


def _rig(folder: Path, stack: ExitStack, cable: Cable, vehicle_end: str, station_end: str) -> Rig:
    vehicle = Vehicle(folder, vehicle_end)
    stack.callback(vehicle.end)
    station = GroundStation(folder, station_end)
    stack.callback(station.end)
    return Rig(vehicle, cable, station)


@pytest.fixture(params=[serial_rig, tcp_rig], ids=["serial", "tcp"])
def rig(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Rig]:
    """Armed, `i` held, the wheels turn."""
    with ExitStack() as stack:
        rig: Rig = request.param(tmp_path, stack)
        rig.station.wait_for(lambda: b"arms" in rig.station.screen, 30, "the drive screen says how to arm")
        rig.station.type("r")
        rig.station.look(0.3)
        rig.station.type("y")
        rig.station.wait_for(lambda: b"hold i to drive" in rig.station.screen, 10, "armed")
        rig.station.hold("i", rig.vehicle.at_full)
        assert rig.vehicle.turning()
        yield rig


def assert_stops(rig: Rig, since: float, later: float = 0.0) -> None:
    """From `since` (when the last demand can have been heard), the wheels stop in time and stay still."""
    limit = NEUTRAL_WITHIN + later + NOISE
    rig.station.wait_for(lambda: not rig.vehicle.turning(), limit + 2, "the wheels stop")
    falls, stops = rig.vehicle.falls_and_stops_after(since)
    assert falls <= FALLS_WITHIN + later + NOISE
    assert stops <= limit
    stopped = time.monotonic()
    rig.station.look(STILL)
    assert not rig.vehicle.moved_since(stopped)


def hold(rig: Rig, seconds: float) -> None:
    """The key stays down, come what may."""
    start = time.monotonic()
    rig.station.hold("i", lambda: time.monotonic() > start + seconds)


def test_key_released(rig: Rig) -> None:
    assert_stops(rig, time.monotonic(), HOLD_TIMEOUT)


def test_a_stop_key_in_a_burst_wins(rig: Rig) -> None:
    rig.station.type("iik")
    assert_stops(rig, time.monotonic())


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_ground_station_killed_or_frozen_with_its_children(rig: Rig, number: signal.Signals) -> None:
    os.killpg(rig.station.process.pid, number)
    assert_stops(rig, time.monotonic())


def test_terminal_closed(rig: Rig) -> None:
    rig.station.close_terminal()
    closed = time.monotonic()
    assert rig.station.process.wait(10) is not None
    until(lambda: not rig.vehicle.turning(), within=NEUTRAL_WITHIN + NOISE + 2)
    _, stops = rig.vehicle.falls_and_stops_after(closed)
    assert stops <= NEUTRAL_WITHIN + NOISE


def test_unplugged_and_back_with_the_key_held_all_along(rig: Rig) -> None:
    """The stale timer stops it; the driver is told; with the link back nothing moves until neutral and a new press."""
    rig.cable.unplug()
    unplugged = time.monotonic()
    hold(rig, 5.0)
    falls, stops = rig.vehicle.falls_and_stops_after(unplugged)
    assert falls <= FALLS_WITHIN + NOISE
    assert stops <= NEUTRAL_WITHIN + NOISE
    seen = rig.station.screen
    assert b"lost" in seen, rig.station.drawn()
    rig.cable.plug()
    back = time.monotonic()
    start = len(rig.station.screen)
    rig.station.hold("i", lambda: b"is back" in rig.station.screen[start:], within=15.0)
    hold(rig, 3.0)
    assert not rig.vehicle.moved_since(back)
    rig.station.look(1.0)  # the key is let go
    rig.station.type("1")  # MANUAL, because the vehicle went to HOLD
    rig.station.look(1.5)
    rig.station.hold("i", rig.vehicle.at_full)
