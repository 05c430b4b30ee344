"""`mavhelm --plain` beside verbs of another shell, as real programs: they drive, and its end stops the wheels."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from groundstation.station_socket.connect import running_stations
from tests.fakes.lines import on_line
from tests.fakes.rover import LONG_LATCH, FakeArduPilot
from tests.ports import free_port
from tests.waits import PATIENCE, wait_until

pytestmark = pytest.mark.e2e
PROGRAM = [sys.executable, "-m", "groundstation"]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_verbs_beside_it_drive_until_it_ends(number: signal.Signals, tmp_path: Path) -> None:
    core, endpoint = FakeArduPilot(station=255, latch=LONG_LATCH), f"udpin:127.0.0.1:{free_port()}"
    printed = tmp_path / "printed"
    with (
        printed.open("w") as output,
        on_line(core, endpoint=endpoint),
        subprocess.Popen([*PROGRAM, "--plain", endpoint], stdout=output, stderr=output) as plain,
    ):
        try:
            wait_until(lambda: "link up" in printed.read_text())
            [station] = running_stations()
            assert printed.read_text().startswith(f"station {station} on {endpoint}; ")
            with subprocess.Popen([*PROGRAM, "drive", "--arm", "--throttle", "50", "--for", "9"]) as driving:
                wait_until(lambda: core.moves, "the wheels do not turn")
                wait_until(lambda: "state ARMED" in printed.read_text())
                plain.send_signal(number)
                at = time.monotonic()
                wait_until(lambda: not core.moves, "the wheels turn on")
                assert core.stopped_at - at < LONG_LATCH / 2
                assert driving.wait(PATIENCE) != 0
            assert plain.wait(PATIENCE) == (-9 if number == signal.SIGKILL else 128 + number)
            wait_until(lambda: running_stations() == [], "the station stays")
        finally:
            plain.kill()


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_a_drive_ends_with_the_station_that_it_runs_in(number: signal.Signals) -> None:
    core, endpoint = FakeArduPilot(station=255, latch=LONG_LATCH), f"udpin:127.0.0.1:{free_port()}"
    with (
        on_line(core, endpoint=endpoint),
        subprocess.Popen([*PROGRAM, "serve", "--headless", endpoint], stderr=subprocess.DEVNULL) as serve,
    ):
        try:
            wait_until(lambda: running_stations() == [serve.pid])
            words = [*PROGRAM, "drive", "--arm", "--throttle", "50", "--for", "9"]
            with subprocess.Popen(words, stderr=subprocess.DEVNULL) as driving:
                wait_until(lambda: core.moves, "the wheels do not turn")
                serve.send_signal(number)
                at = time.monotonic()
                wait_until(lambda: not core.moves, "the wheels turn on")
                assert core.stopped_at - at < LONG_LATCH / 2
                assert driving.wait(PATIENCE) != 0
        finally:
            serve.kill()


def test_it_watches_through_a_station_that_has_the_endpoint(tmp_path: Path) -> None:
    endpoint = f"udpin:127.0.0.1:{free_port()}"
    with (
        on_line(FakeArduPilot(station=255), endpoint=endpoint),
        subprocess.Popen([*PROGRAM, "serve", "--headless", endpoint], stderr=subprocess.DEVNULL) as serve,
    ):
        try:
            wait_until(lambda: running_stations() == [serve.pid])
            command = [*PROGRAM, "--plain", endpoint, "--for", "0.3"]
            done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
            assert (done.returncode, done.stderr) == (0, "")
            assert "link up" in done.stdout
            assert running_stations() == [serve.pid]
        finally:
            serve.terminate()


def test_a_mistake_is_one_line(tmp_path: Path) -> None:
    for words, said in (
        (["udpin:127.0.0.1:0"], "port '0' is not a number"),
        (["udpin:127.0.0.1:1", "--system", "x"], "x"),
    ):
        done = subprocess.run([*PROGRAM, "--plain", *words], capture_output=True, text=True, check=False)
        assert done.returncode == 2
        assert said in done.stderr
        assert done.stderr.count("\n") == 1
    assert running_stations() == []
    assert os.listdir(tmp_path) == []
