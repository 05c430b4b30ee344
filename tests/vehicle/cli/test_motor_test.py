"""Turning one motor: only a little, only for a moment, and neutral on every way out."""

from __future__ import annotations

import os
import pty
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from tests.rows import each_row
from tests.vehicle.motors.controllers import RoboClaw
from tests.vehicle.motors.pty_controller import OnPty
from tests.vehicle.words import said_by
from tests.waits import PATIENCE
from vehicle.cli.motor_test import MotorTestOptions, RefusedError, build_options, run_motor_test
from vehicle.motors import MotorError
from vehicle.motors.simulated import SimulatedMotors
from vehicle.params import Params
from vehicle.storage.param_store import encode

pytestmark = pytest.mark.xdist_group("motor drivers")  # each driver can be used by one vehicle at a time

ASKED: list[str] = []


class Noted(SimulatedMotors):
    """Remembers what it was told."""

    breaks_at = 0
    """The number of the write that fails; 0: none."""

    def __init__(self) -> None:
        super().__init__(2)
        self._writes = 0
        ASKED.append("open")

    def enable(self) -> None:
        super().enable()
        ASKED.append("enable")

    def disable(self) -> None:
        super().disable()
        ASKED.append("disable")

    def set(self, throttles: Sequence[float]) -> None:
        self._writes += any(throttles)
        if any(throttles) and self._writes == self.breaks_at:
            raise MotorError("no reply")
        super().set(throttles)
        ASKED.append(f"{throttles[0]:g} {throttles[1]:g}")


TABLE = {"driver": f"{__name__}:Noted"}


@pytest.fixture(autouse=True)
def _forget(monkeypatch: pytest.MonkeyPatch) -> None:
    ASKED.clear()
    monkeypatch.setattr(Noted, "breaks_at", 0)


@pytest.mark.parametrize(
    ("motor", "drive", "index"),
    [("left", 1, 0), ("RIGHT", 1, 1), ("2", 1, 1), ("steering", 2, 1), ("rear-left", 4, 2), ("4", 3, 3)],
)
def test_a_motor_has_a_name_and_a_number(motor: str, drive: int, index: int) -> None:
    throttles = [0.0] * (2 if drive < 3 else 4)
    throttles[index] = -0.3
    assert build_options(motor, -0.3, 3.0, Params({"DRIVE_TYPE": drive})) == MotorTestOptions(tuple(throttles), 3.0)


def test_the_motor_gets_what_it_gets_when_driving() -> None:
    params = Params({"MOT1_REVERSED": 1, "MOT1_MIN": 20, "MOT2_TRIM": 10})
    assert build_options("left", 0.25, 1.0, params).throttles == pytest.approx((-0.4, 0.0))
    car = Params({"DRIVE_TYPE": 2, "MOT1_TRIM": 10, "MOT2_TRIM": 10, "MOT2_REVERSED": 1})
    assert build_options("throttle", 0.25, 1.0, car).throttles == pytest.approx((0.35, 0.1))
    assert build_options("steering", 0.2, 1.0, car).throttles == pytest.approx((0.0, -0.12))


@each_row(
    ("motor", "throttle", "seconds", "says"),
    [
        ("middle", 0.1, 1.0, "no motor 'middle'; known: left, right, 1, 2"),
        ("0", 0.1, 1.0, "no motor '0'"),
        ("3", 0.1, 1.0, "no motor '3'"),
        ("left", 0.31, 1.0, "throttle 0.31 is not in -0.3 to 0.3"),
        ("left", -1.0, 1.0, "throttle -1 is not"),
        ("left", float("nan"), 1.0, "throttle nan is not"),
        ("left", 0.1, 3.1, "time 3.1 s must be more than 0 and at most 3"),
        ("left", 0.1, 0.0, "time 0 s must be"),
        ("left", 0.1, -100.0, "time -100 s must be"),
        ("left", 0.1, 1e9, "time 1e+09 s must be"),
        ("left", 0.1, float("nan"), "time nan s must be"),
    ],
)
def test_56_what_is_too_much_is_refused(motor: str, throttle: float, seconds: float, says: str) -> None:
    with pytest.raises(RefusedError) as refusal:
        build_options(motor, throttle, seconds, Params())
    assert str(refusal.value).startswith(says)


def test_one_motor_turns_and_ends_neutral_and_without_power() -> None:
    began = time.monotonic()
    assert run_motor_test(TABLE, MotorTestOptions((0.0, 0.2), 0.5)) is None
    assert time.monotonic() - began >= 0.5
    assert ASKED[:2] == ["open", "enable"]
    assert ASKED[2:-3] == ["0 0.2"] * len(ASKED[2:-3])
    assert len(ASKED[2:-3]) >= 3
    assert ASKED[-3:] == ["0 0", "disable", "disable"]


def test_a_driver_that_fails_is_stopped_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Noted, "breaks_at", 3)
    with pytest.raises(MotorError, match="no reply"):
        run_motor_test(TABLE, MotorTestOptions((0.2, 0.0), 1.0))
    assert "0.2 0" in ASKED
    assert ASKED[-3:] == ["0 0", "disable", "disable"]


@pytest.mark.parametrize("waits", [True, False], ids=["sigtimedwait", "sigpending"])
def test_a_signal_ends_it_at_once(waits: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if not waits:  # as on macOS
        monkeypatch.delattr(signal, "sigtimedwait")
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGTERM,))
    signal.pthread_kill(threading.get_ident(), signal.SIGTERM)  # other threads of the test runner do not hold it back
    try:
        assert run_motor_test(TABLE, MotorTestOptions((0.2, 0.0), 3.0)) is signal.SIGTERM
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    assert ASKED.count("0.2 0") == 1
    assert ASKED[-3:] == ["0 0", "disable", "disable"]


def test_wrong_number_of_motors_is_refused_before_any_has_power() -> None:
    with pytest.raises(RefusedError, match="the driver has 2 motors, DRIVE_TYPE needs 4"):
        run_motor_test(TABLE, build_options("3", 0.2, 1.0, Params({"DRIVE_TYPE": 4})))
    assert "enable" not in ASKED


# ---- as a command


@pytest.fixture
def line() -> Iterator[OnPty]:
    with OnPty(RoboClaw()) as opened:
        yield opened


def file_for(line: OnPty, folder: Path) -> Path:
    """What is there already goes on at its end."""
    file = folder / "rover.toml"
    more = file.read_text() if file.exists() else ""
    motors = f'[motors]\ndriver = "roboclaw"\nport = "{line.path}"\nreply_time = 0.05\n'
    file.write_text(f'state = "{folder}"\n{motors}{more}')
    return file


def command(line: OnPty, folder: Path, *words: str) -> list[str]:
    return [sys.executable, "-m", "vehicle", "motor-test", "--config", str(file_for(line, folder)), *words]


def test_without_a_yes_nothing_turns(line: OnPty, tmp_path: Path) -> None:
    ended = subprocess.run(
        command(line, tmp_path, "left"), stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 2
    assert (
        ended.stderr == "mavhelm vehicle motor-test: a wheel will turn; lift the wheels off the ground and add --yes\n"
    )
    assert line.controller.outputs == [0.0, 0.0]
    assert line.tail == b""


@pytest.mark.parametrize(("answer", "code"), [(b"y\n", 0), (b"yes\n", 0), (b"n\n", 2), (b"\n", 2), (b"\x04", 2)])
def test_at_a_terminal_it_asks(line: OnPty, tmp_path: Path, answer: bytes, code: int) -> None:
    ours, theirs = pty.openpty()
    words = command(line, tmp_path, "left", "--throttle", "0.25", "--time", "0.2")
    process = subprocess.Popen(words, stdin=theirs, stderr=subprocess.PIPE, text=True)
    os.write(ours, answer)
    if code == 0:
        line.until(lambda: any(outputs[0] == pytest.approx(0.25, abs=1e-4) for outputs in line.history))
    _, told = process.communicate(timeout=PATIENCE)
    os.close(ours)
    os.close(theirs)
    assert process.returncode == code
    assert any(map(any, line.history)) is (code == 0)
    assert "Are the wheels in the air?" in told
    assert line.controller.outputs == [0.0, 0.0]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_ctrl_c_stops_it(line: OnPty, tmp_path: Path, number: signal.Signals) -> None:
    words = command(line, tmp_path, "right", "--time", "3", "--yes")
    process = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
    line.until(lambda: line.controller.outputs[1] > 0.1)
    process.send_signal(number)
    _, told = process.communicate(timeout=PATIENCE)
    assert (process.returncode, told) == (0, f"mavhelm vehicle motor-test: stopped by {number.name}, motors neutral\n")
    assert line.controller.outputs == [0.0, 0.0]


def test_killed_the_controllers_own_timeout_ends_it(line: OnPty, tmp_path: Path) -> None:
    process = subprocess.Popen(command(line, tmp_path, "right", "--time", "3", "--yes"))
    line.until(lambda: line.controller.outputs[1] > 0.1)
    process.kill()
    process.wait(PATIENCE)
    line.until(lambda: not any(line.controller.outputs))


@pytest.mark.parametrize("where", ["file", "kept", "neither"])
def test_a_reversed_motor_turns_as_the_vehicle_turns_it(line: OnPty, tmp_path: Path, where: str) -> None:
    if where == "file":
        (tmp_path / "rover.toml").write_text("[params]\nMOT2_REVERSED = 1\n")
    elif where == "kept":
        (tmp_path / "parameters").write_bytes(encode({"MOT2_REVERSED": 1.0}))
    words = command(line, tmp_path, "right", "--throttle", "0.25", "--time", "3", "--yes")
    process = subprocess.Popen(words, stderr=subprocess.PIPE)
    wanted = 0.25 if where == "neither" else -0.25
    line.until(lambda: any(right == pytest.approx(wanted, abs=1e-4) for _, right in line.history))
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=PATIENCE)
    assert process.returncode == 0
    assert line.controller.outputs == [0.0, 0.0]


def test_without_knowing_what_is_kept_nothing_turns(line: OnPty, tmp_path: Path) -> None:
    (tmp_path / "parameters").write_bytes(b"MOT2_REVERSED 1.0\n")
    words = ["--config", str(file_for(line, tmp_path)), "right", "--yes"]
    code, _, error = said_by("motor-test", *words)
    damaged = "parameter file damaged; start the vehicle and set a parameter from a ground station to repair it"
    assert (code, error) == (2, f"mavhelm vehicle motor-test: {tmp_path}: {damaged}\n")
    code, _, _ = said_by("motor-test", *words, "--time", "0.1", "--state", str(tmp_path / "elsewhere"))
    assert code == 0


def test_while_a_vehicle_runs_it_is_refused(line: OnPty, tmp_path: Path) -> None:
    words = command(line, tmp_path, "right", "--time", "3", "--yes")
    process = subprocess.Popen(words, stderr=subprocess.DEVNULL)  # holds the motors as a vehicle does
    try:
        line.until(lambda: line.controller.outputs[1] > 0.1)
        process.send_signal(signal.SIGSTOP)  # so that it holds them however long the second takes to start
        second = subprocess.run(words, capture_output=True, text=True, check=False, timeout=PATIENCE)
        assert second.returncode == 1
        assert second.stderr.startswith("mavhelm vehicle motor-test: the motors are in use by another vehicle")
    finally:
        process.kill()
        process.wait(PATIENCE)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("middle --yes", "no motor 'middle'"),
        ("left --throttle 0.5 --yes", "throttle 0.5 is not"),
        ("left --time 60 --yes", "time 60 s must be"),
        ("left --throttle fast", "invalid float value: 'fast'"),
        ("", "the following arguments are required: MOTOR"),
    ],
)
def test_a_mistake_is_one_line(tmp_path: Path, words: str, says: str) -> None:
    file = tmp_path / "rover.toml"
    file.write_text(f'state = "{tmp_path}"\n[motors]\ndriver = "simulated"\n')
    code, out, error = said_by("motor-test", "--config", str(file), *words.split())
    assert (code, out, error.count("\n")) == (2, "", 1)
    assert error.startswith("mavhelm vehicle motor-test: ")
    assert says in error
