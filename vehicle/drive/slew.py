"""Slew rate of one motor: acceleration, deceleration, and a pause before reversing."""

from __future__ import annotations

import math
from typing import NamedTuple

ROUNDING = 1e-9
"""Steps that add up to the whole distance may miss it by a rounding error, which shall not cost a cycle."""


class SlewLimits(NamedTuple):
    """Rates in 1/s (1 is from zero to full in a second), delay in s."""

    accel: float
    decel: float
    reverse_delay: float = 0.0


class Slew:
    """The value of one motor and its ramp."""

    def __init__(self) -> None:
        self.value = 0.0
        self.limited = False
        """The last step did not reach its target because of a rate."""
        self.waiting = False
        """The last step stayed at zero because of the reverse delay."""
        self._direction = 0.0
        self._rested = math.inf

    def reset(self) -> None:
        """Set the value to zero at once: emergency stop or disarmed."""
        self.value = 0.0
        self.limited = self.waiting = False

    def step(self, target: float, dt: float, limits: SlewLimits) -> float:
        """Move towards `target` for `dt` s; return the new value."""
        self.waiting = False
        if target != target:  # NaN: a ramp would turn it into a number and hide it from the gate
            self.value = target
            return target
        value = self.value
        self._rested = 0.0 if value else self._rested + dt
        if value and target * value <= 0.0:
            value = _toward(value, 0.0, limits.decel * dt)
        elif target * self._direction < 0.0 and self._rested < limits.reverse_delay:
            self.waiting = True
        else:
            value = _toward(value, target, (limits.decel if abs(target) < abs(value) else limits.accel) * dt)
        if value:
            self._direction = 1.0 if value > 0.0 else -1.0
        self.value = value
        self.limited = value != target and not self.waiting
        return value


def _toward(value: float, target: float, step: float) -> float:
    difference = target - value
    return target if abs(difference) <= step + ROUNDING else value + math.copysign(step, difference)
