"""From what a wheel is to do to what its motor gets: direction, smallest and largest output, offset, thrust curve.

Everything before this thinks in wheels: 1 is full ahead, however the motor is wired. Pure arithmetic on values that the
ramps have decided. Zero stays zero for every motor that drives, whatever the parameters say.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from vehicle.drive.mixer import clamp
from vehicle.params import MOTORS, Params

PARAM_NAMES = tuple(
    tuple(f"MOT{n}_{what}" for what in ("REVERSED", "MIN", "MAX", "TRIM")) for n in range(1, MOTORS + 1)
)
"""The parameters of each motor."""


class OutputScaling(NamedTuple):
    """One motor's; shares of full, the first smaller than the second. Made when a parameter changes."""

    reversed: bool = False
    smallest: float = 0.0
    """Output of the smallest throttle that is not zero."""
    largest: float = 1.0
    """Output of full throttle, which nothing exceeds."""
    trim: float = 0.0
    """Added to what the motor gets, so the same way for a reversed one."""
    curve: float = 0.0
    """MOT_THST_EXPO, -1..1."""

    def scale_throttle(self, throttle: float) -> float:
        """What a motor that drives gets, for -1..1. The trim never turns it on, round, or beyond its largest."""
        if throttle == 0.0:
            return 0.0
        direction = math.copysign(1.0, -throttle if self.reversed else throttle)
        size = self.smallest + (self.largest - self.smallest) * linearize_thrust(abs(throttle), self.curve)
        return direction * min(self.largest, max(0.0, size + direction * self.trim))

    def scale_steering(self, steering: float) -> float:
        """What a steering servo gets, for -1..1: its centre is the trim, its ends are the largest either way."""
        turned = -steering if self.reversed else steering
        reach = self.largest - self.trim if turned >= 0.0 else self.largest + self.trim
        return clamp(self.trim + turned * reach, self.largest)


def linearize_thrust(throttle: float, curve: float) -> float:
    """Throttle 0..1 that gives this share of the thrust: ArduRover's MOT_THST_EXPO, its formula without its 0/0."""
    if curve == 0.0 or throttle == 0.0 or math.isnan(throttle):  # what is no number stays none, for the last gate
        return throttle
    root = math.sqrt(max(0.0, (1.0 - curve) ** 2 + 4.0 * curve * throttle))
    return min(1.0, 2.0 * throttle / (1.0 - curve + root))


def build_output_scaling(params: Params) -> list[OutputScaling]:
    """Of every motor that there may be."""
    curve, found = params["MOT_THST_EXPO"], []
    for names in PARAM_NAMES:
        reversed_, smallest, largest, trim = [params[name] for name in names]
        found.append(OutputScaling(reversed_ != 0.0, smallest / 100, largest / 100, trim / 100, curve))
    return found


def scale_outputs(wheels: Sequence[float], driven: int, each: Sequence[OutputScaling]) -> tuple[float, ...]:
    """What the motors get, of which the first `driven` drive; each -1..1 where its wheel's value is."""
    pairs = enumerate(zip(wheels, each, strict=False))
    return tuple(
        [fit.scale_throttle(wheel) if at < driven else fit.scale_steering(wheel) for at, (wheel, fit) in pairs]
    )
