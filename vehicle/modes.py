"""MODES: the flight modes of the vehicle, and how ground stations select them. To add a mode, add a row."""

from __future__ import annotations

import math
from enum import Enum

import msgspec

from dialects.modes import Mode
from link.services.command.request import value_or_default


class ModeRequirement(Enum):
    """A sensor that a mode needs."""

    NOTHING = "nothing"
    GYRO = "turn rate"
    POSITION = "position"


class ModeSpec(msgspec.Struct, frozen=True):
    """One mode: what drives the motors, what it needs, and who may select it."""

    mode: Mode
    manual: bool = False
    """The demand of the driver drives the motors."""
    autonomous: bool = False
    """Navigator drives the motors. If neither is set the motors are neutral."""
    requirement: ModeRequirement = ModeRequirement.NOTHING
    selectable: bool = True
    """A ground station may select it."""
    standard: int = 0
    """The MAV_STANDARD_MODE that it implements, or 0."""
    leads_home: bool = False
    """The mode returns from a fence breach, so that it may be chosen outside the fence."""

    @property
    def moves(self) -> bool:
        """Motors may turn in this mode."""
        return self.manual or self.autonomous


MODES: dict[Mode, ModeSpec] = {
    spec.mode: spec
    for spec in (
        ModeSpec(Mode.MANUAL, manual=True),
        ModeSpec(Mode.ACRO, manual=True, requirement=ModeRequirement.GYRO),
        ModeSpec(Mode.HOLD),
        ModeSpec(Mode.LOITER, autonomous=True, requirement=ModeRequirement.POSITION),
        ModeSpec(Mode.AUTO, autonomous=True, requirement=ModeRequirement.POSITION, standard=6),
        ModeSpec(Mode.RTL, autonomous=True, requirement=ModeRequirement.POSITION, standard=5, leads_home=True),
        ModeSpec(Mode.SMART_RTL, autonomous=True, requirement=ModeRequirement.POSITION, leads_home=True),
        ModeSpec(Mode.GUIDED, autonomous=True),
        ModeSpec(Mode.INITIALISING, selectable=False),
    )
}
"""All modes. Of MAV_STANDARD_MODE a rover can offer SAFE_RECOVERY (5) and MISSION (6)."""

PX4_ALIASES: dict[tuple[int, int], Mode] = {
    (4, 3): Mode.HOLD,
    (4, 4): Mode.AUTO,
    (4, 5): Mode.RTL,
    (6, 0): Mode.GUIDED,
}
"""PX4's (main, sub) pairs that MAVSDK sends to an unknown autopilot: hold(), mission, return to launch and offboard.

Only pairs that differ from ArduRover's mode numbers are unambiguous (MAVSDK px4_custom_mode.hpp). OFFBOARD is
ArduRover's FOLLOW, which is not offered.
"""

CUSTOM_MODE_ENABLED = 1
"""MAV_MODE_FLAG_CUSTOM_MODE_ENABLED: without it parameter 2 is not a custom mode."""


def parse_mode(base: float, main: float, sub: float = 0.0) -> Mode | None:
    """Return the mode in parameters 1..3 of DO_SET_MODE; None if it is not offered."""
    sub = value_or_default(sub)
    if not all(math.isfinite(value) and value == int(value) for value in (base, main, sub)):
        return None
    if not int(base) & CUSTOM_MODE_ENABLED:
        return None
    alias = PX4_ALIASES.get((int(main), int(sub)))
    if sub or alias is not None:
        return alias
    return next((mode for mode, spec in MODES.items() if spec.selectable and mode == int(main)), None)


def describe_mode(base: float, main: float, sub: float = 0.0) -> str:
    """Describe the mode in parameters 1..3 of DO_SET_MODE, for a denial."""
    if math.isfinite(base) and not int(base) & CUSTOM_MODE_ENABLED:
        return f"base mode {base:g} without a custom mode"
    return f"mode {main:g}" if not sub else f"mode {main:g}/{sub:g}"


def standard_mode(number: float) -> Mode | None:
    """Return the mode of a MAV_STANDARD_MODE; None if it is not offered."""
    return next((mode for mode, spec in MODES.items() if spec.standard and spec.standard == number), None)


def initial_mode(number: float) -> Mode:
    """Return the mode of INITIAL_MODE; HOLD for an unknown number, which must not keep the vehicle from starting."""
    return next((mode for mode in MODES if mode == number), Mode.HOLD)
