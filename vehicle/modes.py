"""The modes this vehicle offers and how ground stations ask for them. To add a mode, add a line to OFFERED."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

from dialects.modes import Mode
from link.services.command.server import value_or_default


class ModeRequirement(Enum):
    """What a mode cannot do without."""

    NOTHING = "nothing"
    GYRO = "turn rate"
    POSITION = "position"


@dataclass(frozen=True, slots=True)
class ModeSpec:
    """What a mode does to the motors."""

    mode: Mode
    manual: bool = False
    """The driver's demand counts."""
    autonomous: bool = False
    """The vehicle drives by itself. With neither the motors are neutral."""
    requirement: ModeRequirement = ModeRequirement.NOTHING
    selectable: bool = True
    """A ground station may ask for it."""
    standard: int = 0
    """MAV_STANDARD_MODE that it fits."""
    leads_home: bool = False
    """The mode returns from a fence breach, so that it may be chosen outside the fence."""

    @property
    def moves(self) -> bool:
        """Motors may turn in it."""
        return self.manual or self.autonomous


MODES: dict[Mode, ModeSpec] = {
    offer.mode: offer
    for offer in (
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
"""The standard modes of the specification that a rover may use are SAFE_RECOVERY (5) and MISSION (6)."""

PX4_ALIASES: dict[tuple[int, int], Mode] = {
    (4, 3): Mode.HOLD,
    (4, 4): Mode.AUTO,
    (4, 5): Mode.RTL,
    (6, 0): Mode.GUIDED,
}
"""PX4's (main, sub) pairs that MAVSDK sends to an autopilot it does not know: hold(), a mission, the way home,
and offboard.

Only pairs that are none of ArduRover's numbers can be told from them (MAVSDK px4_custom_mode.hpp); OFFBOARD is
ArduRover's FOLLOW, which is not offered.
"""

CUSTOM_MODE_ENABLED = 1
"""MAV_MODE_FLAG_CUSTOM_MODE_ENABLED: without it the number is not a custom mode."""


def parse_mode(base: float, main: float, sub: float = 0.0) -> Mode | None:
    """The offered mode that DO_SET_MODE's parameters 1..3 name; None for anything else."""
    sub = value_or_default(sub)
    if not all(math.isfinite(value) and value == int(value) for value in (base, main, sub)):
        return None
    if not int(base) & CUSTOM_MODE_ENABLED:
        return None
    alias = PX4_ALIASES.get((int(main), int(sub)))
    if sub or alias is not None:
        return alias
    return next((mode for mode, offer in MODES.items() if offer.selectable and mode == int(main)), None)


def describe_mode(base: float, main: float, sub: float = 0.0) -> str:
    """What was asked for, for a refusal: without the flag the number names no mode of ours, also where we have one."""
    if math.isfinite(base) and not int(base) & CUSTOM_MODE_ENABLED:
        return f"base mode {base:g} without a custom mode"
    return f"mode {main:g}" if not sub else f"mode {main:g}/{sub:g}"


def standard_mode(number: float) -> Mode | None:
    """The offered mode that is this MAV_STANDARD_MODE; None for the others."""
    return next((mode for mode, offer in MODES.items() if offer.standard and offer.standard == number), None)


def initial_mode(number: float) -> Mode:
    """HOLD where the number is no mode of ours: a parameter that was set must not keep the vehicle from starting."""
    return next((mode for mode in MODES if mode == number), Mode.HOLD)
