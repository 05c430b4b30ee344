"""Downloads of a real station process from a vehicle that behaves as ArduPilot's, over a real socket."""

from __future__ import annotations

import os
import random
import signal
from pathlib import Path

import pytest

from groundstation.intents.files import GetFile
from groundstation.intents.session import Quit
from tests.fakes.services import ForeignVehicle, foreign_vehicle
from tests.groundstation.screen import Screen, running
from tests.waits import wait_until

pytestmark = pytest.mark.e2e

DATA = random.Random(9).randbytes(2_000_000)
REMOTE = "/APM/LOGS/00000001.BIN"


def begin(screen: Screen, vehicle: ForeignVehicle, folder: Path) -> Path:
    """Begin to download a long file; return its part when there is one."""
    assert vehicle.files is not None
    vehicle.files.files = {REMOTE: DATA}
    screen.see(lambda seen: seen.vehicle is not None)
    screen.client.send(GetFile(request=1, path=REMOTE, folder=str(folder), name="1.bin"))
    screen.see(lambda seen: bool(seen.transfers))
    return folder / "1.bin.part"


def test_a_download_is_written_by_the_station(tmp_path: Path) -> None:
    with foreign_vehicle() as vehicle, Screen(vehicle.endpoint) as screen:
        begin(screen, vehicle, tmp_path)
        wait_until(lambda: (tmp_path / "1.bin").exists())
        assert (tmp_path / "1.bin").read_bytes() == DATA
        assert not (tmp_path / "1.bin.part").exists()


@pytest.mark.usefixtures("patient")
def test_quitting_keeps_what_has_arrived(tmp_path: Path) -> None:
    with foreign_vehicle() as vehicle, Screen(vehicle.endpoint) as screen:
        part = begin(screen, vehicle, tmp_path)
        screen.client.send(Quit())
        wait_until(lambda: not running(screen.client.pid))
        kept = (tmp_path / "1.bin").read_bytes() if (tmp_path / "1.bin").exists() else part.read_bytes()
        assert kept
        assert DATA.startswith(kept)


def test_a_killed_station_leaves_no_file_under_the_final_name(tmp_path: Path) -> None:
    with foreign_vehicle() as vehicle, Screen(vehicle.endpoint) as screen:
        begin(screen, vehicle, tmp_path)
        os.kill(screen.client.pid, signal.SIGKILL)
        wait_until(lambda: not running(screen.client.pid))
        whole = tmp_path / "1.bin"
        assert not whole.exists() or whole.read_bytes() == DATA
