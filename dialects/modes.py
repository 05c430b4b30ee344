"""Modes and their numbers: ArduRover's custom_mode, so that MAVProxy and pymavlink name them right for any rover."""

from __future__ import annotations

from enum import IntEnum

from dialects.enums import Autopilot, ModeFlag


class Mode(IntEnum):
    """A drive mode; the value is ArduRover's custom_mode (ArduPilot Rover/mode.h)."""

    MANUAL = 0
    """The driver's demand goes to the motors, open loop."""
    ACRO = 1
    STEERING = 3
    HOLD = 4
    """Motors neutral."""
    LOITER = 5
    FOLLOW = 6
    SIMPLE = 7
    DOCK = 8
    CIRCLE = 9
    AUTO = 10
    RTL = 11
    SMART_RTL = 12
    GUIDED = 15
    INITIALISING = 16


_BASE = {Mode.GUIDED: ModeFlag.GUIDED, Mode.AUTO: ModeFlag.AUTO, Mode.RTL: ModeFlag.AUTO, Mode.SMART_RTL: ModeFlag.AUTO,
         Mode.MANUAL: ModeFlag.MANUAL, Mode.ACRO: ModeFlag.MANUAL, Mode.STEERING: ModeFlag.MANUAL,
         Mode.SIMPLE: ModeFlag.MANUAL}  # fmt: skip

_PX4_MAIN = {
    1: "MANUAL",
    2: "ALTCTL",
    3: "POSCTL",
    4: "AUTO",
    5: "ACRO",
    6: "OFFBOARD",
    7: "STABILIZED",
    8: "RATTITUDE",
}
"""PX4 keeps the main mode in bits 16-23 of custom_mode (MAVSDK px4_custom_mode.hpp)."""

_PX4_DRIVABLE = frozenset({"MANUAL", "ALTCTL", "POSCTL", "ACRO", "STABILIZED"})

DRIVABLE_MODES = _PX4_DRIVABLE | {mode.name for mode, flags in _BASE.items() if flags & ModeFlag.MANUAL}
"""Names (`mode_name`) of the modes in which the driver's demand moves a rover, of ArduRover and PX4."""

STANDING_MODES = frozenset({Mode.HOLD.name, Mode.INITIALISING.name})
"""Names of the modes in which nothing moves a rover. Every mode in neither set is autonomous."""


def base_mode(mode: Mode, *, armed: bool) -> ModeFlag:
    """`base_mode` of HEARTBEAT for a mode."""
    flags = ModeFlag.CUSTOM | _BASE.get(mode, ModeFlag(0))
    return flags | ModeFlag.ARMED if armed else flags


def mode_name(custom_mode: int, autopilot: int = Autopilot.GENERIC) -> str:
    """The name a driver reads for a HEARTBEAT's custom_mode; "mode 99" for an unknown number."""
    if autopilot == Autopilot.PX4:
        main = (custom_mode >> 16) & 0xFF
        return _PX4_MAIN.get(main, f"mode {main}")
    try:
        return Mode(custom_mode).name
    except ValueError:
        return f"mode {custom_mode}"


def custom_mode(mode: Mode, autopilot: int = Autopilot.GENERIC) -> tuple[int, int]:
    """Parameters 2 and 3 of DO_SET_MODE (main, sub) for a mode.

    PX4 has no HOLD of ArduRover's kind; its AUTO/LOITER (4, 3) is the one that stops a rover.
    Raises ValueError where the autopilot has no such mode.
    """
    if autopilot != Autopilot.PX4:
        return int(mode), 0
    pairs = {Mode.MANUAL: (1, 0), Mode.HOLD: (4, 3), Mode.ACRO: (5, 0), Mode.GUIDED: (6, 0)}
    if mode not in pairs:
        raise ValueError(f"PX4 has no mode {mode.name}")
    return pairs[mode]
