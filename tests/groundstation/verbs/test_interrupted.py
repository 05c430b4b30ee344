"""Verbs that take time, ended by Ctrl-C or kill -9 in the middle: what they leave in the vehicle and on disk.

drive, send and record have tests of their own, with a watchdog and with a vehicle that drives.
"""

from __future__ import annotations

import os
import random
import shlex
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from tests.fakes.params import Param
from tests.fakes.services import ForeignVehicle, foreign_vehicle
from tests.groundstation.formats.test_plan_file import as_text, document
from tests.groundstation.verbs.setup.test_doctor import (
    MAG_CAL_ACCEPT,
    MAG_CAL_CANCEL,
    MAG_CAL_START,
    MOTOR_TEST,
    commanded,
    progress,
)
from tests.groundstation.verbs.test_examples import prepare
from tests.groundstation.verbs.verb_runs import run_verb
from tests.waits import wait_until

Capture = pytest.CaptureFixture[str]
DATA = random.Random(8).randbytes(2_000_000)
MOTORS = {"SERVO1_FUNCTION": Param(73.0), "SERVO3_FUNCTION": Param(74.0)}


def leaves_the_plan(vehicle: ForeignVehicle, killed: bool) -> None:
    assert vehicle.missions.items[0] == []


def leaves_the_values(vehicle: ForeignVehicle, killed: bool) -> None:
    assert {vehicle.params[name].value for name in ("FS_TIMEOUT", "FS_ACTION")} == {1.0}


def leaves_a_beginning(vehicle: ForeignVehicle, killed: bool) -> None:
    assert not Path("got.bin").exists()
    part = Path("got.bin.part")
    have = part.read_bytes() if part.exists() else b""
    assert have == DATA[: len(have)]


def cancels_the_compass(vehicle: ForeignVehicle, killed: bool) -> None:
    if not killed:
        wait_until(lambda: commanded(vehicle, MAG_CAL_CANCEL), "it is cancelled")
    assert not commanded(vehicle, MAG_CAL_ACCEPT)


def stops_the_motor(vehicle: ForeignVehicle, killed: bool) -> None:
    def tests() -> list[tuple[float, float]]:
        return [(each.param3, each.param4) for each in vehicle.of("COMMAND_LONG") if each.command == MOTOR_TEST]

    assert all(seconds <= 0.5 for throttle, seconds in tests() if throttle), "the vehicle stops it by itself"
    if not killed:
        wait_until(lambda: not tests()[-1][0], "the motor is not stopped")


def does_not_move(vehicle: ForeignVehicle, killed: bool) -> None:
    assert (vehicle.mode, vehicle.of("MANUAL_CONTROL"), vehicle.of("RC_CHANNELS_OVERRIDE")) == (0, [], [])


@dataclass(frozen=True)
class Case:
    """A verb that is interrupted once the vehicle has received `after`. `silent`: what it does not answer."""

    words: str
    after: str
    check: Callable[[ForeignVehicle, bool], None]
    silent: frozenset[int] = field(default_factory=frozenset)
    command: int = 0
    """The command that is meant by `after`."""


CASES = {
    "goto": Case("goto --by 5 0", "COMMAND_INT", does_not_move, frozenset({75})),
    "mission put": Case("mission put patrol.plan", "MISSION_ITEM_INT", leaves_the_plan, frozenset({73})),
    "param load": Case("param load rover.param", "PARAM_SET", leaves_the_values, frozenset({23})),
    "log get": Case("log get latest got.bin", "LOG_REQUEST_DATA", leaves_a_beginning),
    "ftp get": Case("ftp get /1.bin got.bin", "FILE_TRANSFER_PROTOCOL", leaves_a_beginning),
    "watch": Case("watch HEARTBEAT.type", "HEARTBEAT", does_not_move),
    "compass": Case("calibrate compass", "COMMAND_LONG", cancels_the_compass, command=MAG_CAL_START),
    "motor": Case("motor 1 10 --for 2", "COMMAND_LONG", stops_the_motor, command=MOTOR_TEST),
}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
@pytest.mark.parametrize("name", CASES)
def test_it_is_ended(
    name: str, number: signal.Signals, capsys: Capture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("patrol.plan").write_text(as_text(document()))
    Path("rover.param").write_text("FS_TIMEOUT 2\nFS_ACTION 2\n")
    case = CASES[name]
    with foreign_vehicle() as vehicle:
        prepare(vehicle)
        vehicle.params |= MOTORS
        vehicle.armed = name == "goto"
        vehicle.logs[:] = [DATA]
        assert vehicle.files is not None
        vehicle.files.files["/1.bin"] = DATA
        vehicle.silent |= case.silent
        vehicle.on_command[MAG_CAL_START] = lambda: vehicle.send(progress(40))
        words = [*shlex.split(case.words), "-e", vehicle.endpoint, "-v", "1", "--station", "never"]
        if number == signal.SIGKILL:
            _kill(words, case, vehicle)
        else:
            _interrupt(words, case, vehicle, capsys)
        case.check(vehicle, number == signal.SIGKILL)


def _has_begun(case: Case, vehicle: ForeignVehicle) -> bool:
    return any(not case.command or each.command == case.command for each in vehicle.of(case.after))


def _kill(words: list[str], case: Case, vehicle: ForeignVehicle) -> None:
    with subprocess.Popen([sys.executable, "-m", "groundstation", *words], stderr=subprocess.DEVNULL) as process:
        wait_until(lambda: _has_begun(case, vehicle), "it does not begin")
        process.kill()
    assert process.returncode == -signal.SIGKILL


def _interrupt(words: list[str], case: Case, vehicle: ForeignVehicle, capsys: Capture) -> None:
    """Run the verb in this process, which gets SIGINT as a terminal sends it."""

    def press() -> None:
        wait_until(lambda: _has_begun(case, vehicle), "it does not begin")
        os.kill(os.getpid(), signal.SIGINT)

    hand = threading.Thread(target=press)
    hand.start()
    ended = run_verb(capsys, *words)
    hand.join()
    assert ended.code == 128 + signal.SIGINT, ended.err
