"""Verbs that need control, one after the other as a script runs them, with our real simulated vehicle over UDP."""

from __future__ import annotations

import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from groundstation.verbs.common.exit_codes import ExitCode
from tests.e2e.programs import Vehicle
from tests.groundstation.verbs.verb_runs import VerbRun, run_demanding, run_verb, start_demanding
from tests.ports import free_port
from tests.waits import Waits, wait_until

pytestmark = pytest.mark.xdist_group("verbs with our vehicle")
Capture = pytest.CaptureFixture[str]
OTHER = ("--system", "100")
PORT = free_port()
NOISE = 0.4
"""s of a busy machine that the kernel does not count as waiting."""
LOG = random.Random(7).randbytes(20_000)


class Verb:
    """Runs `mavhelm words -e vehicle -v 1`."""

    def __init__(self, capsys: Capture, endpoint: str) -> None:
        self._capsys = capsys
        self.endpoint = endpoint

    def __call__(self, *words: str) -> VerbRun:
        return run_verb(self._capsys, *words, "-e", self.endpoint, "-v", "1")

    def status(self, field: str) -> object:
        """Return a field of `status`."""
        return self("status", "--json").records[0][field]


@pytest.fixture(scope="module")
def vehicle(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Vehicle]:
    """A vehicle process; all tests share it, and leave it disarmed and without a driver."""
    endpoint = f"udpin:127.0.0.1:{PORT}"
    logs = tmp_path_factory.mktemp("logs")
    (logs / "00000001.tlog").write_bytes(LOG)
    options = ("--param", "FS_TIMEOUT=10", "--tlog", str(logs))
    process = Vehicle(tmp_path_factory.mktemp("vehicle"), endpoint, *options)
    wait_until(lambda: "ready" in process.errors.read_text(), "the vehicle does not start")
    yield process
    process.end()


@pytest.fixture
def verb(capsys: Capture, vehicle: Vehicle) -> Iterator[Verb]:
    """Runs a verb with the vehicle, which is free again afterwards."""
    run = Verb(capsys, f"udpout:127.0.0.1:{PORT}")
    yield run
    run("disarm")
    run("estop", "--clear")
    run("control", "release")


def test_a_log_comes_with_a_checksum(verb: Verb, tmp_path: Path) -> None:
    """What was left has one wrong byte, which LOG_DATA could not tell."""
    file = tmp_path / "drive.tlog"
    (tmp_path / "drive.tlog.part").write_bytes(b"x" + LOG[1:10_000])
    assert verb("log", "get", "0", str(file)).code == 0
    assert file.read_bytes() == LOG


def test_arm_stop_and_disarm(verb: Verb) -> None:
    assert verb("arm", "--wait", "20").code == 0
    assert (verb.status("armed"), verb.status("gcs_main")) == (True, 254)
    refused = verb("arm", *OTHER)
    assert refused.code == 0
    assert "armed already" in refused.err
    assert verb("stop").code == 0
    assert (verb.status("mode"), verb.status("armed")) == ("HOLD", True)
    assert verb("disarm", *OTHER).code == 0  # of anybody
    assert verb.status("armed") is False


def test_an_emergency_stop_locks_and_its_release_unlocks(verb: Verb) -> None:
    assert verb("estop").code == 0
    assert verb.status("emergency_stop") is True
    refused = verb("arm")
    assert refused.code == ExitCode.REFUSED
    assert "estop --clear" in refused.err
    assert verb("estop", "--clear").code == 0
    assert verb.status("emergency_stop") is False


def test_control_is_taken_kept_and_released(verb: Verb) -> None:
    assert verb("control", "show").out == "Rover 1: nobody is in control\n"
    assert verb("control", "request").code == 0
    assert verb("control", "show", "--json").records[0]["gcs_main"] == 254
    armed = verb("arm", *OTHER)
    assert armed.code == ExitCode.NOT_IN_CONTROL
    assert "GCS 254 is in control" in armed.err
    assert verb("control", "release").code == 0
    assert verb("control", "show").out == "Rover 1: nobody is in control\n"


def test_control_is_given_to_who_asks(verb: Verb) -> None:
    assert verb("control", "give", "100", "--wait", "1.5").code == ExitCode.DIFFERS
    words = ["control", "request", *OTHER, "-v", "1", "-e", verb.endpoint]
    with subprocess.Popen([sys.executable, "-m", "groundstation", *words], stderr=subprocess.DEVNULL) as other:
        given = verb("control", "give", "100", "--wait", "20")
    assert (given.code, other.returncode) == (0, 0), given.err
    assert verb("control", "release", *OTHER).code == 0


def kill_and_see_it_stop(process: subprocess.Popen[str], vehicle: Vehicle) -> None:
    """Kill a verb that drives. The wheels are neutral within 1 s (docs/safety.md) and the delays of the machine."""
    waits = Waits(process.pid, vehicle.process.pid)
    process.send_signal(signal.SIGKILL)
    at = time.monotonic()
    wait_until(vehicle.stands, "the wheels turn on")
    assert vehicle.falls_and_stops_after(at)[1] < 1.0 + NOISE + waits.total()
    assert not vehicle.moved_since(vehicle.outputs()[-1].at)


def test_a_killed_process_leaves_no_demand(verb: Verb, vehicle: Vehicle) -> None:

    def prepare() -> None:
        assert verb("arm", "--wait", "20").code == 0
        assert verb("mode", "MANUAL").code == 0

    words = ["send", "MANUAL_CONTROL", "x=500", "--rate", "20", "--for", "30", "--yes", "-e", verb.endpoint, "-v", "1"]
    with start_demanding(words, vehicle.turning, prepare) as process:
        kill_and_see_it_stop(process, vehicle)


def test_it_is_driven_by_a_process_that_is_killed(verb: Verb, vehicle: Vehicle, tmp_path: Path) -> None:
    keys = tmp_path / "long.keys"  # a late machine takes over 9 s, the most of --for, for the verb that is refused
    turns = "".join(f"{at} press l\n{at}.1 release l\n" for at in range(8, 90, 8))
    keys.write_text(f"0.1 press i\n{turns}95 release i\n")

    def prepare() -> None:
        assert verb("arm", "--wait", "20").code == 0
        assert verb("stop").code == 0  # drive changes to MANUAL

    words = ["drive", "--script", str(keys), "--speed", "0.5", "-e", verb.endpoint, "-v", "1"]
    with start_demanding(words, lambda: vehicle.at_full(0.3), prepare) as process:
        refused = verb("drive", "--arm", "--throttle", "50", "--for", "1", *OTHER)
        assert refused.code == ExitCode.NOT_IN_CONTROL
        wait_until(vehicle.turning, "the refused verb stops the wheels")
        kill_and_see_it_stop(process, vehicle)


def test_it_is_armed_driven_and_disarmed(verb: Verb, vehicle: Vehicle) -> None:
    at = time.monotonic()
    words = ["drive", "--arm", "--wait", "20", "--throttle", "-50", "--for", "1", "-e", verb.endpoint, "-v", "1"]
    driven = run_demanding(*words)
    assert driven.code == 0, driven.err
    assert min(min(each.throttles) for each in vehicle.outputs() if each.at > at) < -0.3
    assert verb.status("armed") is False


def test_a_demand_in_hold_moves_nothing_and_says_so(verb: Verb, vehicle: Vehicle) -> None:
    assert verb("arm", "--wait", "20").code == 0
    assert verb("stop").code == 0
    at = time.monotonic()
    words = ["send", "MANUAL_CONTROL", "x=500", "--rate", "20", "--for", "0.3", "--yes", "-e", verb.endpoint, "-v", "1"]
    sent = run_demanding(*words)
    assert sent.code == 0, sent.err
    assert "ignores demands in HOLD" in sent.err
    assert not vehicle.moved_since(at)


def test_it_drives_itself_until_it_is_stopped(verb: Verb, vehicle: Vehicle) -> None:
    assert verb("arm", "--wait", "20").code == 0
    assert verb("speed", "1.5").code == 0
    sent = verb("goto", "--by", "30", "0")
    assert sent.code == 0, sent.err
    wait_until(vehicle.turning, "the wheels do not turn")
    assert verb("stop").code == 0
    wait_until(vehicle.stands, "the wheels turn on")
    assert verb.status("mode") == "HOLD"
