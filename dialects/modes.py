"""Modes by ArduRover's custom_mode numbers, which MAVProxy and pymavlink name correctly for any rover."""

from __future__ import annotations

import math
from enum import IntEnum

from dialects.enums import Autopilot, ModeFlag


class Mode(IntEnum):
    """A drive mode: ArduRover's custom_mode (ArduPilot Rover/mode.h), and its flag in base_mode of HEARTBEAT."""

    flag: ModeFlag

    def __new__(cls, number: int, flag: int = 0) -> Mode:
        """Make a member of a row below."""
        member = int.__new__(cls, number)
        member._value_ = number
        member.flag = ModeFlag(flag)
        return member

    MANUAL = 0, ModeFlag.MANUAL
    """The operator's demand goes to the motors, open loop."""
    ACRO = 1, ModeFlag.MANUAL
    STEERING = 3, ModeFlag.MANUAL
    HOLD = 4
    """Motors neutral."""
    LOITER = 5
    FOLLOW = 6
    SIMPLE = 7, ModeFlag.MANUAL
    DOCK = 8
    CIRCLE = 9
    AUTO = 10, ModeFlag.AUTO
    RTL = 11, ModeFlag.AUTO
    SMART_RTL = 12, ModeFlag.AUTO
    GUIDED = 15, ModeFlag.GUIDED
    INITIALISING = 16


def base_mode(mode: Mode, *, armed: bool) -> ModeFlag:
    """Return `base_mode` of HEARTBEAT for a mode."""
    flags = ModeFlag.CUSTOM | mode.flag
    return flags | ModeFlag.ARMED if armed else flags


def set_mode_params(custom_mode: int, autopilot: int) -> tuple[float, float, float]:
    """Return parameters 1 to 3 of DO_SET_MODE: PX4 takes main and sub mode apart."""
    if autopilot == Autopilot.PX4:
        return float(ModeFlag.CUSTOM), float(custom_mode >> 16 & 0xFF), float(custom_mode >> 24 & 0xFF)
    return float(ModeFlag.CUSTOM), float(custom_mode), 0.0


def custom_mode_of(base: float, main: float, sub: float, autopilot: int) -> int | None:
    """Return the custom_mode in parameters 1 to 3 of DO_SET_MODE; None if they name none."""
    numbers = (base, main, sub if sub == sub else 0.0)
    if not all(math.isfinite(each) and each == int(each) and each >= 0 for each in numbers):
        return None
    if not int(base) & ModeFlag.CUSTOM:
        return None
    return int(main) << 16 | int(numbers[2]) << 24 if autopilot == Autopilot.PX4 else int(main)
