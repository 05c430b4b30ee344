"""`mavhelm takeoff` and `land`, and a copter for Python programs, on real lines: with altitude as ground truth."""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from dialects.axes import HOVER
from groundstation.verbs.common.exit_codes import ExitCode
from groundstation.verbs.control.flight import altitude
from tests.fakes.flying import FlyingVehicle
from tests.fakes.lines import on_line
from tests.fakes.multicopters import ArduCopter, Px4Quad
from tests.fakes.params import Param
from tests.fakes.services import ARDUPILOT, foreign_vehicle
from tests.waits import PATIENCE, wait_until

pytestmark = pytest.mark.e2e
COPTERS = pytest.mark.parametrize("build", [ArduCopter, Px4Quad])
HEIGHT, LOSS = 4.0, 0.5
HOMEWARD = ("RTL", "LAND", "AUTO_RTL", "AUTO_LAND", "HOLD")


def start(copter_endpoint: str, *words: str) -> subprocess.Popen[str]:
    line = [sys.executable, "-m", "groundstation", *words, "-e", copter_endpoint, "-v", "1", "--system", "255"]
    return subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def verb(copter_endpoint: str, *words: str) -> tuple[int, str]:
    with start(copter_endpoint, *words) as process:
        out, err = process.communicate(timeout=PATIENCE)
    return process.returncode, out + err


@COPTERS
def test_it_takes_off_hovers_and_lands(build: Callable[[], FlyingVehicle]) -> None:
    with on_line(build(), "udpin") as copter:
        code, said = verb(copter.endpoint, "takeoff", f"{HEIGHT:g}")
        assert (code, "is disarmed: `takeoff --arm` arms it" in said) == (ExitCode.REFUSED, True), said
        code, said = verb(copter.endpoint, "takeoff", f"{HEIGHT:g}", "--arm", "--wait", "20")
        assert (code, "hovers at" in said) == (ExitCode.DONE, True), said
        assert copter.highest == pytest.approx(HEIGHT, abs=LOSS)
        code, said = verb(copter.endpoint, "land")
        assert (code, "lands" in said) == (ExitCode.DONE, True), said
        wait_until(lambda: not copter.armed)
        assert copter.hit_ground_at < 1.0
        assert copter.lowest_z >= HOVER


@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGINT, signal.SIGSTOP], ids=lambda each: each.name)
def test_a_verb_that_ends_in_the_climb_lets_nothing_fall(end: signal.Signals) -> None:
    with on_line(ArduCopter(), "udpin") as copter:
        process = start(copter.endpoint, "takeoff", "8", "--arm", "--wait", "20")
        try:
            wait_until(lambda: copter.altitude > 1.5)
            os.kill(process.pid, end)
            wait_until(lambda: copter.mode_name in HOMEWARD)
            wait_until(lambda: not copter.armed)
        finally:
            process.kill()
            process.communicate()
        assert copter.hit_ground_at < 1.0
        assert copter.lowest_z >= HOVER


PROGRAM = """
import sys
from groundstation import Rover
with Rover({endpoint!r}) as rover:
    rover.arm(wait=20)
    rover.take_off({height})
    rover.drive(0.5, seconds=1)
    rover.drive(0, side=0.5, climb=0.5, seconds=1.5)
    print("driven", flush=True)
    sys.stdin.read()
"""
HOVERS_FOR = 5.0
"""s: longer than its failsafe for demands that end."""


@pytest.mark.parametrize(("build", "killed"), [(ArduCopter, True), (Px4Quad, False)])
def test_a_program_keeps_it_hovering_until_it_ends(build: Callable[[], FlyingVehicle], killed: bool) -> None:
    with on_line(build(), "udpin") as copter:
        if isinstance(copter, ArduCopter):
            copter.params["MAV_GCS_SYSID"] = Param(254)
        text = PROGRAM.format(endpoint=copter.endpoint, height=HEIGHT)
        program = [sys.executable, "-c", text]
        with subprocess.Popen(program, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdin is not None
            assert process.stdout is not None
            assert process.stdout.readline() == "driven\n"
            assert copter.north > 0.3
            wait_until(lambda: copter.speed < 0.1)
            assert copter.east > 0.3
            assert copter.lowest_z >= HOVER
            height, at = copter.altitude, time.monotonic()
            assert height > HEIGHT + 0.2
            wait_until(lambda: time.monotonic() > at + HOVERS_FOR or copter.mode_name in HOMEWARD)
            assert copter.mode_name in ("LOITER", "POSCTL")
            assert copter.altitude == pytest.approx(height, abs=LOSS)
            if killed:
                process.kill()
            else:
                process.stdin.close()
            wait_until(lambda: copter.mode_name in HOMEWARD)
        assert copter.altitude == pytest.approx(height, abs=LOSS)
        assert copter.lowest_z >= HOVER


def test_a_script_and_a_demand_move_it_down_and_sideways(tmp_path: Path) -> None:
    script = tmp_path / "run.keys"
    script.write_text("0 press o\n1.0 release o\n1.2 press s\n2.2 release s\n")
    with on_line(ArduCopter(), "udpin") as copter:
        copter.lift(HEIGHT)
        code, said = verb(copter.endpoint, "drive", "--script", str(script))
        assert (code, copter.lowest_z < HOVER) == (ExitCode.DONE, True), said
        assert copter.east > 0.3
        assert HEIGHT - 1.5 < copter.altitude < HEIGHT - 0.1
        code, said = verb(copter.endpoint, "drive", "--side", "-50", "--for", "1")
        assert code == ExitCode.DONE, said
        script.write_text("0 press m\n1 release m\n")
        code, said = verb(copter.endpoint, "drive", "--script", str(script))
        assert (code, "m is no key that moves a copter" in said) == (ExitCode.REFUSED, True), said
        assert copter.mode_name == "LOITER"


def test_what_does_not_fly_is_refused() -> None:
    with foreign_vehicle(ARDUPILOT) as vehicle:
        for words in (("takeoff", "3"), ("land",)):
            code, said = verb(vehicle.endpoint, *words)
            assert (code, "a rover does not fly" in said) == (ExitCode.REFUSED, True), said
        code, said = verb(vehicle.endpoint, "drive", "--climb", "30", "--for", "1")
        assert (code, "a rover does not move sideways and does not climb" in said) == (ExitCode.REFUSED, True), said
    with pytest.raises(argparse.ArgumentTypeError, match="from 1 to 30 m"):
        altitude("31")
