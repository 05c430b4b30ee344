"""RoboClaw driver against a simulated controller on a pseudo-terminal."""

from __future__ import annotations

import time
from typing import Any

import pytest

from tests.vehicle.motors.contract import Bench
from tests.vehicle.motors.pty_controller import OnPty, recorded
from tests.vehicle.motors.serial_contract import (
    MARGIN,
    PATIENT_TRIES,
    SerialContract,
    fault_of,
)
from tests.waits import Waits, wait_until
from vehicle.motors import MotorError, MotorSettingsError, arming_check
from vehicle.motors.drivers import open_motors
from vehicle.motors.roboclaw import RoboClawMotors, RoboClawSettings


class TestRoboClaw(SerialContract):
    kind = "roboclaw"

    def test_the_timeout_is_set_and_read_back_before_it_turns(self, line: OnPty) -> None:
        motors = RoboClawMotors(RoboClawSettings(port=line.path, timeout=0.5))
        assert line.controller.timeout == 0.0
        motors.enable()
        assert line.controller.timeout == 0.5

    @pytest.mark.parametrize("kept", [0.0, 0.1])
    def test_it_does_not_enable_with_another_timeout_than_it_set(self, line: OnPty, kept: float) -> None:
        line.controller.longest_timeout = kept
        motors = RoboClawMotors(RoboClawSettings(port=line.path))
        with pytest.raises(MotorError, match=rf"its serial timeout is {kept:g} s, not 0.3 s"):
            motors.enable()
        motors.set((1.0, 1.0))
        motors.disable()
        assert line.controller.outputs == [0.0, 0.0]

    def test_it_proves_its_timeout_and_turns_nothing(self, line: OnPty) -> None:
        motors = RoboClawMotors(RoboClawSettings(port=line.path, timeout=0.5))
        arming_check(motors)()
        motors.set((1.0, 1.0))
        assert line.controller.timeout == 0.5
        assert line.controller.outputs == [0.0, 0.0]
        line.controller.longest_timeout = 0.1
        with pytest.raises(MotorError, match=r"its serial timeout is 0.1 s, not 0.5 s"):
            arming_check(motors)()

    def test_a_damaged_reply_is_asked_for_again(self, line: OnPty) -> None:
        motors = RoboClawMotors(RoboClawSettings(port=line.path))
        line.controller.garbled = 2
        motors.enable()
        motors.disable()
        line.controller.garbled = PATIENT_TRIES
        with pytest.raises(MotorError, match="invalid reply"):
            motors.enable()

    def test_it_tells_its_version(self, line: OnPty) -> None:
        motors = RoboClawMotors(RoboClawSettings(port=line.path))
        assert motors.version() == "USB Roboclaw 2x7a v4.2.8"
        line.controller.mute = True
        with pytest.raises(MotorError, match="invalid reply, none"):
            motors.version()

    def test_no_reply_at_start_is_said_with_what_to_look_at(self, line: OnPty) -> None:
        line.controller.mute = True
        with pytest.raises(MotorError, match="no reply: is it on, in packet serial mode") as caught:
            RoboClawMotors(RoboClawSettings(port=line.path))
        assert "\n" not in str(caught.value)

    def test_missing_replies_while_driving_end_it_in_fifth_of_second(self, bench: Bench, line: OnPty) -> None:
        self.drive(bench)
        line.controller.mute = True
        waits, began = Waits(), time.monotonic()
        assert "no reply" in fault_of(bench.motors, calls=100, pause=0.02)
        assert 0.19 < time.monotonic() - began < 0.2 + MARGIN + waits.total()

    def test_a_dead_controller_delays_each_cycle_by_one_reply_only(self, line: OnPty) -> None:
        motors = RoboClawMotors(RoboClawSettings(port=line.path))
        line.controller.mute = True
        with pytest.raises(MotorError):
            motors.disable()
        assert min(self.refused_in(motors) for _ in range(10)) < 0.06  # the best of them: the machine is shared
        line.controller.mute = False
        wait_until(
            lambda: self.is_stopped(motors), "acknowledged again"
        )  # one try a cycle, 20 ms: the line may be late

    @staticmethod
    def is_stopped(motors: RoboClawMotors) -> bool:
        """Return whether `disable` succeeds."""
        try:
            motors.disable()
        except MotorError:
            return False
        return True

    @staticmethod
    def refused_in(motors: RoboClawMotors) -> float:
        """s until `disable` gives up."""
        began = time.monotonic()
        with pytest.raises(MotorError):
            motors.disable()
        return time.monotonic() - began

    def test_a_controller_that_lost_its_power_gets_its_timeout_again(self, line: OnPty) -> None:
        times = iter([0.0, 0.02, 1.1, 1.2])
        motors = RoboClawMotors(RoboClawSettings(port=line.path), clock=times.__next__)
        motors.enable()
        line.controller.lose_power()
        motors.set((0.5, 0.5))
        motors.set((0.5, 0.5))
        line.until(lambda: line.controller.timeout == 0.3)

    def test_frames_are_those_of_the_manual(self, line: OnPty) -> None:
        motors = RoboClawMotors(RoboClawSettings(port=line.path, address=0x80))
        motors.enable()
        frames = recorded(motors.port)
        motors.set((1.0, -1.0))
        assert frames[0][:-2] == bytes([0x80, 34, 0x7F, 0xFF, 0x80, 0x01])
        line.outputs_after(frames)
        assert line.controller.bad_packets == 0

    @pytest.mark.parametrize(
        ("settings", "says"),
        [
            ({}, "needs settings, at least port"),
            ({"port": "/dev/x", "timeout": 0.6}, "timeout: Expected `float` <= 0.5"),
            ({"port": "/dev/x", "timeout": 0}, "timeout: Expected `float` >= 0.1"),
            ({"port": "/dev/x", "address": 0x90}, "address: Expected `int` <= 135"),
            ({"port": "/dev/x", "speed": 1}, "unknown field `speed`"),
        ],
    )
    def test_settings_are_read_strictly(self, settings: dict[str, Any], says: str) -> None:
        with pytest.raises(MotorSettingsError) as caught:
            open_motors("roboclaw", settings)
        assert says in str(caught.value)
