"""The modes this vehicle offers and how ground stations ask for them. To add a mode, add a line to OFFERED."""

from __future__ import annotations

import math
from dataclasses import dataclass

from dialects.modes import Mode


@dataclass(frozen=True, slots=True)
class Offer:
    """What a mode does to the motors."""

    mode: Mode
    manual: bool
    """The driver's demand counts; else the motors are neutral."""


OFFERED: dict[Mode, Offer] = {
    Mode.MANUAL: Offer(Mode.MANUAL, manual=True),
    Mode.HOLD: Offer(Mode.HOLD, manual=False),
}

PX4_ALIASES: dict[tuple[int, int], Mode] = {(4, 3): Mode.HOLD}
"""PX4's (main, sub) pairs that MAVSDK sends to an autopilot it does not know; AUTO/LOITER is its hold().

Only pairs with a sub mode can be told from ArduRover's numbers (MAVSDK px4_custom_mode.hpp).
"""

CUSTOM_MODE_ENABLED = 1
"""MAV_MODE_FLAG_CUSTOM_MODE_ENABLED: without it the number is not a custom mode."""


def asked_mode(base: float, main: float, sub: float = 0.0) -> Mode | None:
    """The offered mode that DO_SET_MODE's parameters 1..3 name; None for anything else."""
    if not all(math.isfinite(value) and value == int(value) for value in (base, main, sub)):
        return None
    if not int(base) & CUSTOM_MODE_ENABLED:
        return None
    if sub:
        return PX4_ALIASES.get((int(main), int(sub)))
    return next((mode for mode in OFFERED if mode == int(main)), None)
