from __future__ import annotations

import termios
import time
from typing import Any

import pytest

from dialects.enums import Command, Result
from tests.vehicle.bench import CYCLE, said
from tests.vehicle.motors.controllers import RoboClaw
from tests.vehicle.motors.pty_controller import OnPty
from tests.vehicle.motors.serial_contract import (
    KINDS,
    InMachine,
)
from vehicle.motors import MotorError
from vehicle.motors.drivers import open_motors
from vehicle.motors.serial_controller import SerialController


@pytest.mark.parametrize("kind", KINDS)
def test_a_rover_whose_controller_proves_no_timeout_cannot_arm(kind: str) -> None:
    """The rover itself in its machine; then the same one with a controller that does."""
    make, settings, _ = KINDS[kind]
    for proven in (False, True):
        with OnPty(make()) as line:
            if not proven:
                line.controller.longest_timeout = 0.1
            own = {"port": line.path, **settings, **({"timeout_proven": proven} if kind == "sabertooth" else {})}
            motors = open_motors(kind, own)
            try:
                bench = InMachine(motors)
                bench.wait(CYCLE)
                answer = bench.command(Command.COMPONENT_ARM_DISARM, 1)
                bench.wait(0.5)
                assert (answer is Result.ACCEPTED, bench.armed) == (proven, proven), (answer, bench.texts)
                assert said(bench, "PreArm: motor driver: ") is not proven
                assert line.controller.outputs == [0.0, 0.0]
            finally:
                motors.close()


@pytest.mark.parametrize("kind", KINDS)
def test_a_port_that_is_not_there_is_said_in_one_line(kind: str) -> None:
    with pytest.raises(MotorError, match="/dev/nowhere is not there; is it plugged in") as caught:
        open_motors(kind, {"port": "/dev/nowhere"})
    assert "\n" not in str(caught.value)
    for path in ("/tmp", "/dev/null"):
        with pytest.raises(MotorError, match=f"{path} is not a serial port"):
            open_motors(kind, {"port": path})


@pytest.mark.parametrize("kind", KINDS)
def test_port_that_goes_during_set_up_is_an_error_of_the_motors(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def gone(*words: Any) -> None:  # no pty goes between two calls of the same function; a loose plug does
        raise termios.error(5, "Input/output error")

    with OnPty(RoboClaw()) as line:
        monkeypatch.setattr(termios, "tcsetattr", gone)
        with pytest.raises(MotorError, match="is not there; is it plugged in"):
            open_motors(kind, {"port": line.path})


def test_a_timeout_between_two_steps_is_rounded_to_the_safe_side() -> None:
    controllers = [SerialController("", "", 9600, value, time.monotonic) for value in (0.1, 0.29, 0.3, 0.5)]
    assert [each.timeout_tenths for each in controllers] == [1, 2, 3, 5]
