"""The motors of one vehicle that can be tested, and the commands that turn and stop one of them."""

from __future__ import annotations

import math
from collections.abc import Mapping

import msgspec

from dialects import messages as m
from dialects.enums import Autopilot, Command
from groundstation.vehicles.readings.outputs import FUNCTIONS, drive_names

TURN_TIME = 0.5
"""s of one request: a station that is killed renews it no more, and the vehicle itself ends it."""

MOST_MOTORS = 4
"""Keys 1 to 4."""

PX4_SERVO = 33
"""ACTUATOR_OUTPUT_FUNCTION_SERVO1."""

ARDUPILOT_INSTANCES: Mapping[float, int] = {70: 1, 26: 2, 73: 3, 74: 4}
"""SERVOn_FUNCTION -> parameter 1 of DO_MOTOR_TEST in ArduRover: throttle, steering, left and right throttle
(AR_Motors/AP_MotorsUGV.h, motor_test_order)."""


class TestedMotor(msgspec.Struct, frozen=True):
    """A motor that can be tested."""

    name: str
    output: str
    """Where it is connected, as the vehicle says; "" if it does not."""
    instance: int
    """As the command names it."""
    reverse: str = ""
    """The parameter that reverses it; "" if it is not known."""

    __test__ = False


def motors_of(
    autopilot: int, info: m.RoverDriveInfo | None, functions: Mapping[int, float], *, rover_dialect: bool
) -> tuple[TestedMotor, ...]:
    """Return the motors of a vehicle; `functions` are the known SERVOn_FUNCTION."""
    if autopilot == Autopilot.ARDUPILOT:
        return _ardupilot(functions)
    if autopilot == Autopilot.PX4:
        drives = [TestedMotor(f"motor {number}", f"Motor{number}", number) for number in (1, 2)]
        return (*drives, TestedMotor("servo 1", "Servo1", PX4_SERVO))
    if not rover_dialect:
        return ()
    count = min(MOST_MOTORS, info.motor_count) if info is not None else 2
    names = drive_names(info, count)
    return tuple(
        TestedMotor(name, f"MOT{number}", number, f"MOT{number}_REVERSED") for number, name in enumerate(names, 1)
    )


def _ardupilot(functions: Mapping[int, float]) -> tuple[TestedMotor, ...]:
    return tuple(
        TestedMotor(FUNCTIONS[function], f"SERVO{channel} {function:.0f}", instance, f"SERVO{channel}_REVERSED")
        for channel, function in sorted(functions.items())
        if (instance := ARDUPILOT_INSTANCES.get(function)) is not None
    )[:MOST_MOTORS]


def build_turn(
    autopilot: int, motor: TestedMotor, throttle: float, seconds: float
) -> tuple[Command, tuple[float, ...]]:
    """Return the command that turns a motor for `seconds`, and its parameters."""
    if autopilot == Autopilot.ARDUPILOT:
        return Command.DO_MOTOR_TEST, (motor.instance, 0, throttle * 100, seconds, 1, 0, 0)
    return Command.ACTUATOR_TEST, (throttle, seconds, 0, 0, motor.instance, 0, 0)


def build_stop(autopilot: int, motor: TestedMotor) -> tuple[Command, tuple[float, ...]]:
    """Return the command that ends a test. ArduPilot has none: a test of 0 s at 0 % ends the one under way."""
    if autopilot == Autopilot.ARDUPILOT:
        return Command.DO_MOTOR_TEST, (motor.instance, 0, 0, 0, 1, 0, 0)
    return Command.ACTUATOR_TEST, (math.nan, 0, 0, 0, motor.instance, 0, 0)


def is_turn(message: m.Message) -> bool:
    """Return whether this message turns a motor: it must not be sent late."""
    if not isinstance(message, m.CommandLong):
        return False
    if message.command == Command.ACTUATOR_TEST:
        return not math.isnan(message.param1) and bool(message.param2)
    return message.command == Command.DO_MOTOR_TEST and bool(message.param3)
