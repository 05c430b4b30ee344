"""The drivers of GPIO pins through gpiozero, lgpio and the kernel's GPIO character device."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from dialects.axes import Axes
from dialects.enums import Command
from dialects.messages import CommandLong
from tests.vehicle.ground import Ground
from tests.vm.inside.header import (
    ENABLE,
    ESTOP,
    FORWARD,
    GPIO,
    GUARDED,
    ahead,
    button,
    drive,
    duty,
    level,
    rover,
    safe_stop,
    silent,
    write_config,
)  # fmt: skip
from tests.waits import PATIENCE


@pytest.fixture
def ground() -> Iterator[Ground]:
    with Ground() as ground:
        yield ground


def test_the_wheels_turn_and_stop(tmp_path: Path, ground: Ground) -> None:
    with rover(write_config(tmp_path, ground.endpoint, GPIO)):
        drive(ground)
        ground.wait(ahead, "both motors run forward")
        ground.demand = Axes(throttle=0.5)
        ground.wait(lambda: all(0.3 < duty(pin) < 0.7 for pin in FORWARD), "PWM of about one half")
        ground.demand = Axes()
        ground.wait(silent, "all inputs are low")


def test_silence_of_the_ground_station_stops_them(tmp_path: Path, ground: Ground) -> None:
    with rover(write_config(tmp_path, ground.endpoint, GPIO)):
        drive(ground)
        ground.wait(ahead, "both motors run forward")
        ground.say = lambda message: None  # type: ignore[method-assign]
        ground.wait(silent, "all inputs are low")


def test_after_kill_9_the_pins_keep_their_level_until_safe_stop(tmp_path: Path, ground: Ground) -> None:
    config = write_config(tmp_path, ground.endpoint, GPIO)
    with rover(config) as process:
        drive(ground)
        ground.wait(ahead, "both motors run forward")
        process.kill()
        process.wait(PATIENCE)
        assert ahead(), "as on a Pi: the pins keep their level without a process"
        assert "article-car: motors neutral" in safe_stop(config)
        assert silent()


def test_an_ordinary_end_leaves_them_low(tmp_path: Path, ground: Ground) -> None:
    with rover(write_config(tmp_path, ground.endpoint, GPIO)) as process:
        drive(ground)
        ground.wait(ahead, "both motors run forward")
        process.terminate()
        assert process.wait(PATIENCE) == 0
        assert silent()


def test_the_emergency_stop_button_cuts_them(tmp_path: Path, ground: Ground) -> None:
    def armed() -> bool:
        button(ESTOP, pressed=False)
        ground.say(CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0))
        return ground.armed

    with rover(write_config(tmp_path, ground.endpoint, GUARDED)):
        ground.demand = Axes()
        ground.wait(armed, "the contact is closed, it arms")
        ground.demand = Axes(throttle=1.0)
        ground.wait(lambda: ahead() and level(ENABLE) == 1, "both motors run forward, their power is on")
        button(ESTOP, pressed=True)
        ground.wait(lambda: silent() and level(ENABLE) == 0, "all inputs are low, the power is off")
        button(ESTOP, pressed=False)
        ground.wait(lambda: not ground.armed, "it is disarmed")
        assert silent()
        assert level(ENABLE) == 0
