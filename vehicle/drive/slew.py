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
        if math.isnan(target):  # a ramp would turn NaN into a number and hide it from the gate
            self.value = target
            return target
        self._rested = 0.0 if self.value else self._rested + dt
        if self.value and target * self.value <= 0.0:
            self._toward(0.0, limits.decel * dt)
        elif self._must_wait(target, limits.reverse_delay):
            self.waiting = True
        else:
            rate = limits.decel if abs(target) < abs(self.value) else limits.accel
            self._toward(target, rate * dt)
        if self.value:
            self._direction = math.copysign(1.0, self.value)
        self.limited = self.value != target and not self.waiting
        return self.value

    def _must_wait(self, target: float, delay: float) -> bool:
        return target * self._direction < 0.0 and self._rested < delay

    def _toward(self, target: float, step: float) -> None:
        difference = target - self.value
        self.value = target if abs(difference) <= step + ROUNDING else self.value + math.copysign(step, difference)
