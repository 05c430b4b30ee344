"""Modes by ArduRover's custom_mode numbers, which MAVProxy and pymavlink name correctly for any rover."""

from __future__ import annotations

from enum import IntEnum

from dialects.enums import Autopilot, ModeFlag, VehicleType


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
"""PX4's main mode, from bits 16-23 of custom_mode (MAVSDK px4_custom_mode.hpp)."""

_PX4_DRIVABLE = frozenset({"MANUAL", "ALTCTL", "POSCTL", "ACRO", "STABILIZED"})

DRIVABLE_MODES = _PX4_DRIVABLE | {mode.name for mode in Mode if mode.flag & ModeFlag.MANUAL}
"""Names (`mode_name`) of the modes in which the driver's demand moves a rover, of ArduRover and PX4."""

STANDING_MODES = frozenset({Mode.HOLD.name, Mode.INITIALISING.name})
"""Names of the modes in which nothing moves a rover. Every mode in neither set is autonomous."""


def base_mode(mode: Mode, *, armed: bool) -> ModeFlag:
    """Return `base_mode` of HEARTBEAT for a mode."""
    flags = ModeFlag.CUSTOM | mode.flag
    return flags | ModeFlag.ARMED if armed else flags


def mode_name(custom_mode: int, autopilot: int = Autopilot.GENERIC) -> str:
    """Return the name of a HEARTBEAT's custom_mode; "mode 99" for an unknown number."""
    if autopilot == Autopilot.PX4:
        main = (custom_mode >> 16) & 0xFF
        return _PX4_MAIN.get(main, f"mode {main}")
    try:
        return Mode(custom_mode).name
    except ValueError:
        return f"mode {custom_mode}"


def custom_mode(mode: Mode, autopilot: int = Autopilot.GENERIC) -> tuple[int, int]:
    """Return parameters 2 and 3 of DO_SET_MODE (main mode, sub mode) for a mode.

    PX4 has no HOLD mode like ArduRover's; its AUTO/LOITER (4, 3) is the one that stops a rover.
    Raises ValueError if the autopilot has no such mode.
    """
    if autopilot != Autopilot.PX4:
        return int(mode), 0
    pairs = {Mode.MANUAL: (1, 0), Mode.HOLD: (4, 3), Mode.ACRO: (5, 0), Mode.GUIDED: (6, 0)}
    if mode not in pairs:
        raise ValueError(f"PX4 has no mode {mode.name}")
    return pairs[mode]


_PX4_AUTO = {3: "AUTO_LOITER", 4: "AUTO_MISSION", 5: "AUTO_RTL"}
"""Sub modes of PX4's AUTO that a rover has, from bits 24-31 of custom_mode (PX4 px4_custom_mode.h)."""


def known_modes(autopilot: int, kind: int) -> dict[str, int]:
    """Return name -> custom_mode of a vehicle that does not list its modes; empty for one that is not known.

    `kind` is MAV_TYPE: other vehicles of ArduPilot have other numbers.
    """
    if autopilot == Autopilot.PX4:
        main = {name: number << 16 for number, name in _PX4_MAIN.items() if name != "AUTO"}
        return main | {name: 4 << 16 | sub << 24 for sub, name in _PX4_AUTO.items()}
    if kind in (VehicleType.GROUND_ROVER, VehicleType.SURFACE_BOAT):
        return {mode.name: int(mode) for mode in Mode if mode is not Mode.INITIALISING}
    return {}


def set_mode_params(custom_mode: int, autopilot: int) -> tuple[float, float, float]:
    """Return parameters 1 to 3 of DO_SET_MODE: PX4 takes main and sub mode apart."""
    if autopilot == Autopilot.PX4:
        return float(ModeFlag.CUSTOM), float(custom_mode >> 16 & 0xFF), float(custom_mode >> 24 & 0xFF)
    return float(ModeFlag.CUSTOM), float(custom_mode), 0.0
