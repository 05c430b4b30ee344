"""The verbs that a script of CI runs one after the other: each a process, with the real vehicle over UDP."""

from __future__ import annotations

import math
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from groundstation.station_socket.connect import running_stations
from tests.e2e.programs import Vehicle
from tests.ports import free_port
from tests.waits import PATIENCE, Waits, wait_until

pytestmark = pytest.mark.e2e
HOME = (-35.363262, 149.165237)
METRES_PER_DEGREE = 111_319.5
CORNERS = ((8, 0), (8, 8), (0, 8))
"""m north and east of home."""
FS_GCS_TIMEOUT = 12
"""s; more than the default of 5, because a process may take some seconds to start where the machine is shared."""
NOISE = 0.4
"""s of a busy machine that the kernel does not count as waiting."""


def write_corner(path: Path) -> None:
    """Write a mission with a turn."""
    lines = ["QGC WPL 110", f"0\t1\t0\t16\t0\t0\t0\t0\t{HOME[0]}\t{HOME[1]}\t584\t1"]
    for number, (north, east) in enumerate(CORNERS, 1):
        latitude = HOME[0] + north / METRES_PER_DEGREE
        longitude = HOME[1] + east / METRES_PER_DEGREE / math.cos(math.radians(HOME[0]))
        lines.append(f"{number}\t0\t3\t16\t0\t0\t0\t0\t{latitude:.7f}\t{longitude:.7f}\t0\t1")
    path.write_text("\n".join(lines) + "\n")


@pytest.fixture
def port() -> int:
    return free_port()


@pytest.fixture(params=["links of its own", "a running station"])
def way(request: pytest.FixtureRequest, port: int) -> Iterator[Sequence[str]]:
    """The arguments with which each verb gets to the vehicle."""
    endpoint = f"udpin:127.0.0.1:{port}"
    if request.param == "links of its own":
        yield "-e", endpoint
        return
    station = subprocess.Popen(
        [sys.executable, "-m", "groundstation", "serve", "--headless", endpoint], stderr=subprocess.DEVNULL
    )
    wait_until(lambda: station.pid in running_stations(), "the station does not start")
    yield "--station", str(station.pid)
    station.terminate()
    assert station.wait(PATIENCE) == 0


def test_arm_upload_start_and_watch_a_mission(tmp_path: Path, port: int, way: Sequence[str]) -> None:
    """The vehicle drives while `watch` keeps the session of the verb before, and holds some seconds after its end."""
    corner = tmp_path / "corner.waypoints"
    write_corner(corner)
    vehicle = Vehicle(tmp_path, port, "--param", f"FS_GCS_TIMEOUT={FS_GCS_TIMEOUT}")
    script: Sequence[Sequence[str]] = (
        ("arm", "--wait", "20"),
        ("mission", "put", str(corner)),
        ("mission", "start"),
        ("watch", "MISSION_CURRENT.seq", "--until", "==2", "--timeout", "90"),
    )
    try:
        for words in script:
            began = time.monotonic()
            command = [sys.executable, "-m", "groundstation", *words, *way]
            ended = subprocess.run(command, capture_output=True, text=True, timeout=2 * PATIENCE)
            assert ended.returncode == 0, (words, ended.stderr, vehicle.errors.read_text())
        at = time.monotonic()
        assert at - began > FS_GCS_TIMEOUT
        waits = Waits(vehicle.process.pid)
        wait_until(vehicle.turning, "the wheels stand")  # a script that ends is not a stop; the failsafe is
        assert ended.stdout.split()[-1] == "2"
        assert "this one keeps its session" in ended.stderr
        wait_until(vehicle.stands, "the wheels turn on")
        assert vehicle.falls_and_stops_after(at)[1] < FS_GCS_TIMEOUT + 1 + NOISE + waits.total()
        wait_until(lambda: "Failsafe: ground station lost: HOLD" in vehicle.errors.read_text(), "another stop")
    finally:
        vehicle.end()
