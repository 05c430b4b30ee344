"""The rover at a serial cable of 57600 baud: driven through the bridge, and by a ground station on the port."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.e2e.cable import SerialCable
from tests.e2e.programs import GroundStation, Vehicle, drive, drive_on
from tests.e2e.relay import Relay
from tests.waits import PATIENCE, Waits

pytestmark = pytest.mark.e2e

NEUTRAL_WITHIN = 1.7
"""s from the last demand to stopped wheels: stale after 0.45, ramp 0.4, and what waits.py does not count."""
RELEASED_WITHIN = 3.0
"""s from the last repeat of a key: the same, and the time until the key counts as released."""


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def bridge(stack: ExitStack, *endpoints: str) -> subprocess.Popen[bytes]:
    process = subprocess.Popen([sys.executable, "-m", "link.bridge", *endpoints, "--quiet"])
    stack.callback(process.wait, PATIENCE)
    stack.callback(process.kill)
    return process


def stands_within(station: GroundStation, vehicle: Vehicle, limit: float, since: float, waits: Waits) -> None:
    """Check that the wheels, which turned until now, have stopped in time."""
    station.wait_for(vehicle.stands, PATIENCE, "the wheels stop")
    assert vehicle.outputs()[-1].at - since < limit + waits.total()


def test_the_rover_is_driven_through_a_bridge_from_udp_to_serial(stack: ExitStack, tmp_path: Path) -> None:
    cable, relay = SerialCable(tmp_path), Relay()
    stack.callback(cable.close)
    stack.callback(relay.close)
    station = GroundStation(tmp_path, f"udpin:127.0.0.1:{relay.ground_port}")
    stack.callback(station.end)
    vehicle = Vehicle(tmp_path, cable.one)
    stack.callback(vehicle.end)
    process = bridge(stack, cable.two, f"udpout:127.0.0.1:{relay.vehicle_port}")

    drive(station, vehicle, relay.armed)
    waits, released = Waits(vehicle.process.pid, station.process.pid, process.pid), time.monotonic()
    stands_within(station, vehicle, RELEASED_WITHIN, released, waits)

    drive_on(station, vehicle)
    waits, killed = Waits(vehicle.process.pid), time.monotonic()
    process.send_signal(signal.SIGKILL)
    stands_within(station, vehicle, NEUTRAL_WITHIN, killed, waits)

    bridge(stack, cable.two, f"udpout:127.0.0.1:{relay.vehicle_port}")
    drive_on(station, vehicle)


def test_station_on_port_drives_and_unplugging_stops_the_wheels(stack: ExitStack, tmp_path: Path) -> None:
    cable = SerialCable(tmp_path)
    stack.callback(cable.close)
    station = GroundStation(tmp_path, cable.two)
    stack.callback(station.end)
    vehicle = Vehicle(tmp_path, cable.one)
    stack.callback(vehicle.end)

    drive(station, vehicle, station.says_armed)

    waits, unplugged = Waits(vehicle.process.pid), time.monotonic()
    cable.unplug()
    stands_within(station, vehicle, NEUTRAL_WITHIN, unplugged, waits)

    cable.plug()
    drive_on(station, vehicle)
