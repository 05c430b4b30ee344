"""The ground station without arguments: the Connect screen, an endpoint typed there, and the wheels turn."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.e2e.programs import GroundStation, Vehicle, drive
from tests.ports import free_port
from tests.waits import PATIENCE

pytestmark = pytest.mark.e2e


@pytest.fixture
def station(tmp_path: Path) -> Iterator[GroundStation]:
    made = GroundStation(tmp_path)
    yield made
    made.end()


def test_an_endpoint_that_is_typed_drives(station: GroundStation, tmp_path: Path) -> None:
    port = free_port()
    vehicle = Vehicle(tmp_path, f"udpin:127.0.0.1:{port}")
    try:
        station.wait_for(lambda: b"heard now" in station.screen, PATIENCE, "the Connect screen")
        station.type(":")
        station.wait_for(lambda: b"serial:/dev/ttyUSB0:57600" in station.screen, PATIENCE, "the field")
        station.type(f"udpout:127.0.0.1:{port}\r")
        drive(station, vehicle, station.says_armed)
        station.wait_for(vehicle.stands, PATIENCE, "no key is held, and the wheels stop")
        station.type("\x11")
        assert station.ended() == 0
    finally:
        vehicle.end()
