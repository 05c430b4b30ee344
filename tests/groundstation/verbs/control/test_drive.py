"""`mavhelm drive` with vehicles as ArduPilot and PX4 behave; with ours: test_with_our_vehicle.py."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from groundstation.verbs.common.exit_codes import ExitCode
from tests.fakes.params import Param
from tests.fakes.services import ARDUPILOT, PX4, ForeignVehicle, foreign_vehicle
from tests.groundstation.verbs.driving_process import check_signal, check_standstill
from tests.groundstation.verbs.verb_runs import VerbRun, run_demanding, run_verb
from tests.waits import PATIENCE, wait_until

Capture = pytest.CaptureFixture[str]
PX4_MANUAL, PX4_MISSION = 1 << 16, 4 << 16 | 4 << 24


def drive(vehicle: ForeignVehicle, *words: str) -> VerbRun:
    """Run the verb with a vehicle."""
    return run_demanding("drive", *words, "-e", vehicle.endpoint, "-v", "1")


SECONDS = "0.5"
"""To hold a demand: a program that is late for all of that says that it stood still, and runs again."""
LAST = 5
"""Neutral demands at the end."""


def demands(vehicle: ForeignVehicle, neutral: tuple[int, int]) -> list[tuple[int, int]]:
    """Return the axes y and z of all demands, once the last ones have been read: the verb may end before."""

    def all_demands() -> list[tuple[int, int]]:
        return [(each.y, each.z) for each in vehicle.of("MANUAL_CONTROL")]

    wait_until(lambda: all_demands()[-LAST:] == [neutral] * LAST, lambda: f"not neutral in the end: {all_demands()}")
    return all_demands()


DRIVE = ("drive", "--throttle", "40", "--for", "9")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGHUP, signal.SIGKILL])
def test_a_process_that_a_signal_ends_leaves_no_demand(number: signal.Signals) -> None:
    check_signal(number, *DRIVE)


def test_stopped_process_leaves_no_demand_and_does_not_drive_on() -> None:
    check_standstill(*DRIVE)


@pytest.mark.parametrize(("airframe", "steering"), [(None, [(300, 350)]), (5, [(-300, 350)])])
def test_the_axes_of_px4(airframe: int | None, steering: list[tuple[int, int]]) -> None:
    with foreign_vehicle(PX4) as vehicle:
        vehicle.armed, vehicle.mode = True, PX4_MANUAL
        if airframe is None:
            vehicle.silent.add(20)
        else:
            vehicle.params["CA_AIRFRAME"] = Param(float(airframe), 6)
        driven = drive(vehicle, "--throttle", "-30", "--steering", "30", "--for", SECONDS)
        assert driven.code == 0, driven.err
        sent = demands(vehicle, neutral=(0, 500))
        assert sent[:2] == [(0, 500)] * 2
        assert sorted(set(sent) - {(0, 500)}) == steering


def test_a_script_with_an_ardupilot_that_is_armed_and_disarmed(tmp_path: Path) -> None:
    script = tmp_path / "run.keys"
    script.write_text("0.2 press comma\n0.7 press right\n1.2 release right\n1.7 release comma\n")  # SECONDS each
    with foreign_vehicle(ARDUPILOT) as vehicle:
        driven = drive(vehicle, "--script", str(script), "--arm", "--speed", "0.4")
        assert (driven.code, vehicle.armed) == (0, False), driven.err
        assert "and is disarmed" in driven.err
        moves = [each for each in demands(vehicle, neutral=(0, 0)) if each != (0, 0)]
        assert sorted(set(moves), key=moves.index) == [(0, -400), (-400, -400)]  # in reverse a wheel turns the tail


def test_it_needs_an_armed_vehicle_that_takes_demands() -> None:
    with foreign_vehicle(PX4) as vehicle:
        vehicle.mode = PX4_MISSION
        words = ("--throttle", "30", "--for", "2")
        disarmed = drive(vehicle, *words)
        assert (disarmed.code, vehicle.of("MANUAL_CONTROL")) == (ExitCode.REFUSED, [])
        assert "is disarmed: `drive --arm` arms it" in disarmed.err
        vehicle.armed = True
        itself = drive(vehicle, *words)
        assert itself.code == ExitCode.REFUSED
        assert "drives itself (AUTO_MISSION); `mavhelm stop` stops it" in itself.err
        assert vehicle.of("MANUAL_CONTROL") == []


def test_it_ends_when_the_vehicle_disarms_itself() -> None:
    with foreign_vehicle() as vehicle:
        vehicle.armed = True
        command = [sys.executable, "-m", "groundstation", "drive", "--throttle", "30", "--for", "9"]
        words = [*command, "-e", vehicle.endpoint, "-v", "1"]
        with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as process:
            wait_until(lambda: any(each.z for each in vehicle.of("MANUAL_CONTROL")), "it does not drive")
            vehicle.change_mode(0, armed=False)
            assert process.wait(PATIENCE) == ExitCode.REFUSED
            assert process.stderr is not None
            assert "is disarmed after" in process.stderr.read()


@pytest.mark.parametrize(
    ("words", "error"),
    [
        ([], "write --throttle or --steering PERCENT with --for S"),
        (["--throttle", "30"], "write --throttle or --steering PERCENT with --for S"),
        (["--throttle", "0", "--for", "1"], "write --throttle or --steering PERCENT with --for S"),
        (["--throttle", "101", "--for", "1"], "'101' is not from -100 to 100 %"),
        (["--throttle", "30", "--for", "12"], "--for: 9 s at most; --script drives longer"),
        (["--script", "run.keys", "--for", "1"], "--script cannot be combined with"),
        (["--script", "missing.keys"], "missing.keys"),
    ],
)
def test_mistakes(capsys: Capture, words: list[str], error: str) -> None:
    wrong = run_verb(capsys, "drive", *words)
    assert wrong.code == ExitCode.USAGE
    assert error in wrong.err
