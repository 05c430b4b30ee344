"""The demands that a vehicle gets of a station, and a screen that drives it and is killed with -9."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.fakes.lines import on_line
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.screen import running
from tests.ports import free_port
from tests.waits import Waits, wait_until

ROOT = Path(__file__).resolve().parents[2]


def moving(vehicle: FakeVehicle, since: float) -> list[float]:
    """Return when the demands arrived that move the vehicle."""
    return [at for at, x in vehicle.demands(since) if x]


def neutral(vehicle: FakeVehicle, since: float) -> list[float]:
    """Return when the neutral demands arrived."""
    return [at for at, x in vehicle.demands(since) if not x]


def assert_said_neutral(vehicle: FakeVehicle, since: float) -> None:
    """Check that the last demands of the station were five neutrals."""
    wait_until(lambda: len(neutral(vehicle, since)) >= 5)
    assert len(neutral(vehicle, since)) == 5
    assert not moving(vehicle, neutral(vehicle, since)[0])


@contextmanager
def killed_screen(within: float, *options: str) -> Iterator[tuple[FakeVehicle, int, float]]:
    """Start a screen and its station, see the wheels turn, kill the screen, see neutral `within` s.

    Yields the vehicle, the station's process id, and when the screen was killed. The station ends with the block.
    """
    endpoint = f"udpin:127.0.0.1:{free_port()}"
    command = [sys.executable, "-m", "tests.groundstation.parent", endpoint, *options]
    station = 0
    with (
        on_line(FakeVehicle(), endpoint=endpoint) as vehicle,
        subprocess.Popen(command, stdout=subprocess.PIPE, cwd=ROOT) as parent,
    ):
        try:
            assert parent.stdout is not None
            station = int(parent.stdout.readline())
            wait_until(lambda: bool(moving(vehicle, 0.0)))
            waits, killed = Waits(station), time.monotonic()
            parent.kill()
            wait_until(lambda: bool(neutral(vehicle, killed)))
            assert neutral(vehicle, killed)[0] - killed < within + waits.total()
            yield vehicle, station, killed
        finally:
            parent.kill()
            if station and running(station):
                os.kill(station, signal.SIGKILL)
