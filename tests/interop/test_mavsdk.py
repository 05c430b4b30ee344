"""MAVSDK: finds the vehicle, reads what it is and where, sets parameters, drives it, and reads its files."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.interop.conftest import Rover
from vehicle.params import TABLE

pytestmark = [
    pytest.mark.interop,
    pytest.mark.skipif(
        importlib.util.find_spec("mavsdk") is None and "MAVHELM_CI" not in os.environ,
        reason='MAVSDK is not installed: pip install -e ".[interop]"',
    ),
]

CLIENT = Path(__file__).parent / "mavsdk_client.py"
INSTANT = 0.5
"""s: MAVSDK's own timeouts begin at this."""


class Step(NamedTuple):
    """What a step of the client came to."""

    value: object
    error: str | None
    took: float


class Client:
    """The script with one of its scenarios, as a process."""

    def __init__(self, port: int, scenario: str, folder: Path) -> None:
        self._log = folder / "mavsdk.log"
        with self._log.open("w") as log:
            self._process = subprocess.Popen(
                [sys.executable, str(CLIENT), str(port), scenario, str(folder)],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, text=True, cwd=folder,
            )  # fmt: skip
        self._patience = threading.Timer(40, self._process.kill)
        self._patience.start()

    def step(self, name: str) -> Step:
        """Wait for the end of the step; others before it are passed over."""
        assert self._process.stdout is not None
        for line in self._process.stdout:
            told = json.loads(line)
            if told["step"] == name:
                return Step(told["value"], told["error"], told["took"])
        raise AssertionError(f"no step {name!r}\n{self._log.read_text()}")

    def good(self, name: str) -> Step:
        """Wait for a step that must succeed."""
        step = self.step(name)
        assert step.error is None, f"{name}: {step.error}\n{self._log.read_text()}"
        return step

    def go_on(self) -> None:
        """What it waits for."""
        assert self._process.stdin is not None
        self._process.stdin.write("\n")
        self._process.stdin.flush()

    def end(self) -> None:
        """End it, whatever state it is in."""
        self._patience.cancel()
        self._process.kill()
        self._process.communicate()


@pytest.fixture
def client(rover: Rover, tmp_path: Path) -> Iterator[Callable[[str], Client]]:
    """Starts a scenario; returns when MAVSDK has found the vehicle."""
    started: list[Client] = []

    def start(scenario: str) -> Client:
        started.append(Client(rover.port, scenario, tmp_path))
        assert started[-1].good("discover").took < 1.5
        return started[-1]

    yield start
    for each in started:
        each.end()


def test_what_it_is_and_where(client: Callable[[str], Client]) -> None:
    sdk = client("identity")
    sdk.good("version")
    for stream in ("position", "home", "attitude_euler", "velocity_ned", "gps_info", "battery", "heading"):
        sdk.good(stream)
    assert "ON_GROUND" in str(sdk.good("landed_state").value)
    sdk.good("health")


def test_parameters(client: Callable[[str], Client]) -> None:
    sdk = client("parameters")
    assert sdk.good("all").value == len(TABLE)
    assert sdk.good("get").value == pytest.approx(1.5)
    sdk.good("set")
    assert sdk.good("get again").value == pytest.approx(1.4)
    for refused in ("unknown", "set unknown", "out of range"):
        step = sdk.step(refused)
        assert step.error is not None
        assert step.took < INSTANT


def test_it_drives_by_hand(client: Callable[[str], Client], rover: Rover) -> None:
    sdk = client("driving")
    sdk.good("arm")
    rover.drives()
    sdk.go_on()
    sdk.good("hold")
    rover.stands()
    sdk.good("disarm")


def test_it_drives_by_itself(client: Callable[[str], Client], rover: Rover) -> None:
    sdk = client("guided")
    for order in ("goto", "return", "offboard"):
        sdk.good(order)
        rover.drives()
        sdk.go_on()
    sdk.good("stop")
    rover.stands()
    sdk.good("disarm")


def test_a_mission_from_upload_to_its_end(client: Callable[[str], Client], rover: Rover) -> None:
    sdk = client("mission")
    sdk.good("upload")
    assert sdk.good("download").value is True
    assert "UNSUPPORTED" in str(sdk.step("refused").error)
    sdk.good("fence")
    assert sdk.good("fence back").value == 3
    sdk.good("arm")
    sdk.good("start")
    rover.drives()
    sdk.good("progress")
    assert sdk.good("finished").value is True
    sdk.good("disarm")
    sdk.good("clear")
    assert sdk.good("empty").value == 0


def test_files_logs_and_what_the_parameters_mean(client: Callable[[str], Client]) -> None:
    sdk = client("files")
    assert "parameter.json.xz" in str(sdk.good("root").value)
    for path in ("/parameter.json.xz", "@PARAM/param.pck"):
        assert "SUCCESS" in str(sdk.good(path).value)
    assert sdk.good("same").value is True
    assert "DOES_NOT_EXIST" in str(sdk.step("no file").value)
    assert sdk.step("write").error is not None
    sdk.step("logs")
    assert sdk.good("metadata").value is True
    assert "SPEED_MAX" in str(sdk.good("meaning").value)
