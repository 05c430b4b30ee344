"""The screen's end of the pipe: starting a station that cannot work, and reading its snapshots late."""

from __future__ import annotations

import socket
import time

import pytest

from groundstation.client import StationClient, StationError
from groundstation.intents.driving import DriveKeyUp
from tests.fakes.lines import on_line
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.screen import FORWARD, Screen
from tests.waits import wait_until

pytestmark = pytest.mark.e2e


def moving(vehicle: FakeVehicle, since: float) -> list[float]:
    return [at for at, x in vehicle.demands(since) if x]


@pytest.mark.parametrize(
    ("endpoint", "words"),
    [
        ("carrier:pigeon", "udpin:HOST:PORT"),
        ("udpin:127.0.0.1:99999", "port '99999' is not a number from 1 to 65535"),
        ("udpin:no-such-host.invalid:14550", "is not known"),
    ],
)
def test_start_errors_are_one_line(endpoint: str, words: str) -> None:
    with pytest.raises(StationError) as caught:
        StationClient.start([endpoint])
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_port_in_use() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        with pytest.raises(StationError, match="is in use"):
            StationClient.start([f"udpin:127.0.0.1:{taken.getsockname()[1]}"])


def test_a_screen_that_does_not_read_blocks_nothing() -> None:
    with Screen() as screen, on_line(FakeVehicle(), endpoint=screen.endpoint) as vehicle:
        screen.drive(vehicle)
        start = time.monotonic()

        def has_driven() -> bool:
            if not moving(vehicle, time.monotonic() - 1.0):  # a busy machine let the lease run out: press anew
                screen.client.send(DriveKeyUp(key="i"), FORWARD)
            return len(moving(vehicle, start)) > 30

        wait_until(has_driven)
        newest = screen.client.receive()
        assert newest is not None
        assert newest.number > screen.snapshot.number + 5, "the newest one, not the oldest"
