"""The rover behind a serial cable of 57600 baud: driven through the bridge, and by a ground station on the port."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.e2e.cable import SerialCable
from tests.e2e.programs import GroundStation, Vehicle, drive
from tests.e2e.relay import Relay

pytestmark = pytest.mark.e2e

NEUTRAL_WITHIN = 1.2
"""s from the last demand to wheels at rest: stale after 0.45, ramp 0.4, and the machine is shared."""


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def bridge(stack: ExitStack, *endpoints: str) -> subprocess.Popen[bytes]:
    process = subprocess.Popen([sys.executable, "-m", "link.bridge", *endpoints, "--quiet"])
    stack.callback(process.wait, 10)
    stack.callback(process.kill)
    return process


def wait(station: GroundStation, condition: Callable[[], bool], within: float, what: str) -> float:
    station.wait_for(condition, within, what)
    return time.monotonic()


def drive_on(station: GroundStation, vehicle: Vehicle, tries: int = 8) -> None:
    """Let go, back to MANUAL, press again, until it drives: after a gap of 2 s the vehicle stands in HOLD, and it wants
    to see a neutral demand first."""
    for _ in range(tries):
        station.type("1")
        station.look(0.6)
        with contextlib.suppress(AssertionError):
            station.hold("i", vehicle.at_full, within=2.0)
            return
    raise AssertionError(f"it does not drive again; {vehicle.errors.read_text()}")


def test_the_rover_is_driven_through_the_bridge_from_udp_to_serial_and_back(stack: ExitStack, tmp_path: Path) -> None:
    cable, relay = SerialCable(tmp_path), Relay()
    stack.callback(cable.close)
    stack.callback(relay.close)
    station = GroundStation(tmp_path, f"udpin:127.0.0.1:{relay.ground_port}")
    stack.callback(station.end)
    vehicle = Vehicle(tmp_path, cable.one)
    stack.callback(vehicle.end)
    process = bridge(stack, cable.two, f"udpout:127.0.0.1:{relay.vehicle_port}")

    drive(station, vehicle, relay)
    released = time.monotonic()
    at_rest = wait(station, lambda: not vehicle.turning(), 10, "the wheels stop when the key is let go")
    assert at_rest - released < 3.0

    station.hold("i", vehicle.at_full)
    process.send_signal(signal.SIGKILL)
    killed = time.monotonic()
    at_rest = wait(station, lambda: not vehicle.turning(), 10, "the wheels stop when the bridge is killed")
    assert at_rest - killed < NEUTRAL_WITHIN + 0.5

    bridge(stack, cable.two, f"udpout:127.0.0.1:{relay.vehicle_port}")
    drive_on(station, vehicle)


def test_a_ground_station_on_the_port_drives_and_an_unplugged_cable_stops_the_wheels(
    stack: ExitStack, tmp_path: Path
) -> None:
    cable = SerialCable(tmp_path)
    stack.callback(cable.close)
    station = GroundStation(tmp_path, cable.two)
    stack.callback(station.end)
    vehicle = Vehicle(tmp_path, cable.one)
    stack.callback(vehicle.end)

    station.wait_for(lambda: b"arms" in station.screen, 30, "the drive screen says how to arm")
    station.type("r")
    station.wait_for(lambda: b"yes, any other key" in station.screen, 10, "it asks whether to arm")
    station.type("y")
    station.wait_for(lambda: b"hold i to drive" in station.screen, 20, "the drive screen says that keys drive")
    station.hold("i", vehicle.at_full)

    cable.unplug()
    unplugged = time.monotonic()
    at_rest = wait(station, lambda: not vehicle.turning(), 10, "the wheels stop when the cable is pulled")
    assert at_rest - unplugged < NEUTRAL_WITHIN + 0.5

    cable.plug()
    drive_on(station, vehicle)
