"""Sabertooth driver against a simulated controller on a pseudo-terminal."""

from __future__ import annotations

from typing import Any

import pytest

from tests.vehicle.motors.contract import Bench
from tests.vehicle.motors.pty_controller import OnPty, recorded
from tests.vehicle.motors.serial_contract import (
    SerialContract,
    fault_of,
)
from vehicle.motors import MotorError, MotorSettingsError
from vehicle.motors.drivers import open_motors
from vehicle.motors.sabertooth import SabertoothMotors, SabertoothSettings


class TestSabertooth(SerialContract):
    kind = "sabertooth"

    def test_it_does_not_enable_before_a_person_proves_the_timeout(self, line: OnPty) -> None:
        motors = SabertoothMotors(SabertoothSettings(port=line.path))
        with pytest.raises(MotorError, match="set timeout_proven = true"):
            motors.enable()
        motors.set((1.0, 1.0))
        frames = recorded(motors.port)
        motors.disable()
        assert line.outputs_after(frames) == [0.0, 0.0]

    def test_the_timeout_is_set_at_each_enable(self, line: OnPty) -> None:
        motors = SabertoothMotors(SabertoothSettings(port=line.path, timeout=0.4, timeout_proven=True))
        line.until(lambda: line.controller.timeout == 0.4)
        line.controller.lose_power()
        motors.enable()
        line.until(lambda: line.controller.timeout == 0.4)

    def test_a_controller_that_lost_power_gets_its_timeout_again(self, line: OnPty) -> None:
        times = iter([0.0, 0.02, 1.1])
        settings = SabertoothSettings(port=line.path, timeout_proven=True)
        motors = SabertoothMotors(settings, clock=times.__next__)
        motors.enable()
        line.controller.lose_power()
        motors.set((0.5, 0.5))
        motors.set((0.5, 0.5))
        line.until(lambda: line.controller.timeout == 0.3)

    def test_a_stop_gets_through_a_line_that_was_full(self, bench: Bench, line: OnPty) -> None:
        motors: Any = bench.motors
        self.drive(bench)
        line.deaf.set()
        assert fault_of(motors, calls=100_000)
        motors.disable()
        line.deaf.clear()
        line.until(lambda: line.controller.outputs == [0.0, 0.0])

    def test_frames_are_those_of_the_manual(self, line: OnPty) -> None:
        """Its example: address 130, command 0, data 64, checksum 66."""
        motors = SabertoothMotors(SabertoothSettings(port=line.path, address=130, timeout_proven=True))
        motors.enable()
        frames = recorded(motors.port)
        motors.set((64 / 127, -1.0))
        assert frames == [bytes([130, 0, 64, 66]) + bytes([130, 5, 127, (130 + 5 + 127) & 127])]

    @pytest.mark.parametrize(
        ("settings", "says"),
        [
            ({"port": "/dev/x", "baud": 4800}, "baud: Invalid enum value 4800"),
            ({"port": "/dev/x", "timeout": 1.0}, "timeout: Expected `float` <= 0.5"),
            ({"port": "/dev/x", "address": 0x80, "proven": True}, "unknown field `proven`"),
        ],
    )
    def test_settings_are_read_strictly(self, settings: dict[str, Any], says: str) -> None:
        with pytest.raises(MotorSettingsError) as caught:
            open_motors("sabertooth", settings)
        assert says in str(caught.value)
