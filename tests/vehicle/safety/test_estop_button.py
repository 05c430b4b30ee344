"""The emergency stop button at the pins of a real process, from its start on."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from dialects.axes import Axes
from dialects.enums import Command, Result, SystemState
from dialects.messages import CommandAck, CommandLong, Heartbeat
from tests.vehicle.ground import Ground, drive, running
from tests.vehicle.motors.filed_pins import installed

BUTTON, ENABLE = 17, 22
WHEELS = {10, 9, 8, 7}
CAR = f"""
[motors]
driver = "article-car"
safety = {{ estop_pin = {BUTTON}, enable_pin = {ENABLE} }}
"""


def asking(ground: Ground, command: int, value: float, result: Result) -> Callable[[], bool]:
    """Ask until it is answered so."""

    def answered() -> bool:
        ground.say(CommandLong(1, 1, command, 0, value, 0, 0, 0, 0, 0, 0))
        acks = [message for message in ground.heard if isinstance(message, CommandAck) and message.command == command]
        return bool(acks) and acks[-1].result == result

    return answered


def status(ground: Ground) -> int | None:
    beats = [message for message in ground.heard if isinstance(message, Heartbeat)]
    return int(beats[-1].system_status) if beats else None


@pytest.mark.e2e
def test_the_button_open_at_the_start_then_closed_then_pressed(tmp_path: Path) -> None:
    file = tmp_path / "rover.toml"
    switch = Command.DO_SET_SAFETY_SWITCH_STATE
    with installed(tmp_path) as header, Ground() as ground:
        file.write_text(f'endpoints = ["{ground.endpoint}"]\n{CAR}')
        with running(tmp_path, "--config", str(file)) as vehicle:
            vehicle.ready()
            ground.demand = Axes()
            ground.wait(lambda: status(ground) == SystemState.EMERGENCY, "no wire: pressed from the start on")
            ground.wait(asking(ground, Command.COMPONENT_ARM_DISARM, 1, Result.FAILED), "arming is refused")
            ground.wait(asking(ground, switch, 1, Result.FAILED), "so is a release")

            header.hold(BUTTON, high=False)
            ground.wait(asking(ground, switch, 1, Result.ACCEPTED), "closed it is released")
            drive(ground, vehicle)
            ground.wait(lambda: bool(header.driven_high() & WHEELS), "the pins turn the wheels")
            assert ENABLE in header.driven_high()

            header.hold(BUTTON, high=True)
            ground.wait(lambda: not header.driven_high(), "all pins are low")
            ground.wait(lambda: status(ground) == SystemState.EMERGENCY, "and the vehicle says why")
            assert any("EMERGENCY STOP by button" in text for text in ground.texts())
