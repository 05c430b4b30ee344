from __future__ import annotations

import os
from itertools import count
from pathlib import Path

import pytest

from tests.vehicle.motors.contract import Bench, MotorsContract
from vehicle.motors import MotorError
from vehicle.motors.log import LoggedMotors, MotorLog
from vehicle.motors.simulated import SimulatedMotors


class TestLoggedMotors(MotorsContract):
    """The wrapper is as safe as what it wraps."""

    @pytest.fixture
    def bench(self) -> Bench:
        motors = SimulatedMotors()
        return Bench(LoggedMotors(motors, lambda line: None, lambda: 0), lambda: motors.outputs, lambda: motors.enabled)


def logged() -> tuple[LoggedMotors, list[str]]:
    lines: list[str] = []
    return LoggedMotors(SimulatedMotors(), lines.append, count(1000).__next__), lines


def test_writes_one_line_for_each_change() -> None:
    motors, lines = logged()
    motors.enable()
    for throttles in ((0.25, -1.0), (0.25, -1.0), (0.5, 0.5)):
        motors.set(throttles)
    assert lines == ["1000 0.2500 -1.0000\n", "1001 0.5000 0.5000\n"]


@pytest.mark.parametrize("stop", ["disable", "close"])
def test_ends_with_neutral(stop: str) -> None:
    motors, lines = logged()
    motors.enable()
    motors.set((0.5, 0.5))
    getattr(motors, stop)()
    getattr(motors, stop)()
    assert lines == ["1000 0.5000 0.5000\n", "1001 0.0000 0.0000\n"]


def test_what_turns_nothing_is_not_written() -> None:
    motors, lines = logged()
    motors.set((0.5, 0.5))
    motors.enable()
    with pytest.raises(MotorError):
        motors.set((2.0, 0.0))
    assert lines == []


def test_the_file_is_appended_to_and_seen_at_once(tmp_path: Path) -> None:
    path = tmp_path / "motors"
    path.write_text("earlier\n")
    log = MotorLog(str(path))
    log.write("1 0.0 0.0\n")
    assert path.read_text() == "earlier\n1 0.0 0.0\n"


def test_a_full_disk_is_remembered_and_not_raised() -> None:
    log = MotorLog("/dev/full")
    log.write("1 0.0 0.0\n")
    assert log.fault is not None
    log.write("2 0.0 0.0\n")


def test_a_file_that_cannot_be_opened_is_the_callers_matter(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="No such file"):
        MotorLog(str(tmp_path / "missing" / "motors"))


def test_a_reader_who_stops_reading_does_not_hold_up_the_motors(tmp_path: Path) -> None:
    path = tmp_path / "motors"
    os.mkfifo(path)
    with pytest.raises(OSError, match="No such device"):
        MotorLog(str(path))
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    log = MotorLog(str(path))
    for _ in range(10_000):
        log.write("1000 0.5000 0.5000\n")
    assert isinstance(log.fault, BlockingIOError)
    os.close(reader)
