"""What sensors and self-driving find wrong while armed, each with the time it began; what follows is failsafe.py's.

Demands, ground station and battery have their own watches (failsafe_inputs.py).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from dialects.enums import Failsafe
from vehicle.navigation.estimate import Estimate
from vehicle.params import Params
from vehicle.readings import Readings

BLOCKED_THROTTLE_MIN = 0.2
"""Throttle from which on a rover must move (vehicle.md, blocked) ..."""
BLOCKED_SPEED_MAX = 0.05
"""... faster than this, m/s."""


class HazardInputs(NamedTuple):
    """What is looked at in a cycle."""

    readings: Readings
    estimate: Estimate
    throttles: Sequence[float]
    """Of the wheels that drive, as they are to turn."""
    needs_position: bool
    """What drives goes by the estimate's place."""
    guided_lost: float | None
    """When a setpoint got or will get too old."""
    outside: bool
    """Beyond the fence."""


class HazardMonitor:
    """Remembers since when."""

    def __init__(self, params: Params) -> None:
        self._params = params
        self._since: dict[Failsafe, float] = {}

    def update(self, look: HazardInputs, now: float) -> dict[Failsafe, float]:
        """What holds now -> since when."""
        holds = {
            Failsafe.POSITION: look.needs_position and not look.estimate.good,
            Failsafe.FENCE: look.outside,
            Failsafe.TILT: self._tilted(look.readings),
            Failsafe.BLOCKED: self._blocked(look),
        }
        self._since = {cause: self._since.get(cause, now) for cause, there in holds.items() if there}
        if look.guided_lost is None or now <= look.guided_lost:
            return self._since
        return {**self._since, Failsafe.GUIDED_LOSS: look.guided_lost}

    def _tilted(self, readings: Readings) -> bool:
        largest = math.radians(self._params["CRASH_ANGLE"])
        return largest > 0.0 and any(abs(angle or 0.0) > largest for angle in (readings.roll, readings.pitch))

    @staticmethod
    def _blocked(look: HazardInputs) -> bool:
        if max(map(abs, look.throttles)) < BLOCKED_THROTTLE_MIN:
            return False
        wheels = look.readings.wheel_speeds
        if wheels:
            return max(map(abs, wheels)) < BLOCKED_SPEED_MAX
        return look.estimate.speed is not None and look.estimate.ground_speed < BLOCKED_SPEED_MAX
