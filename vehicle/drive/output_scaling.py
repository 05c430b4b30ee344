"""Converts wheel values to motor values: direction, minimum, maximum, trim and thrust curve.

Before this step all values are those of wheels: 1 is full forward, whatever the wiring. The functions are pure and
follow the ramps. Zero stays zero for every driven motor, whatever the parameters are.
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
"""Names of the parameters of each motor."""


class OutputScaling(NamedTuple):
    """The scaling of one motor, as shares of full output; `smallest` is below `largest`."""

    reversed: bool = False
    smallest: float = 0.0
    """Output of the smallest throttle above zero."""
    largest: float = 1.0
    """Output of full throttle, which is never exceeded."""
    trim: float = 0.0
    """Added to the output, in the same direction for a reversed motor."""
    curve: float = 0.0
    """MOT_THST_EXPO, -1..1."""

    def scale_throttle(self, throttle: float) -> float:
        """Return the output of a driven motor for throttle -1..1.

        The trim never starts the motor, reverses it or exceeds its largest output.
        """
        if throttle == 0.0:
            return 0.0
        direction = math.copysign(1.0, -throttle if self.reversed else throttle)
        size = self.smallest + (self.largest - self.smallest) * linearize_thrust(abs(throttle), self.curve)
        return direction * min(self.largest, max(0.0, size + direction * self.trim))

    def scale_steering(self, steering: float) -> float:
        """Return the output of a steering servo for -1..1: the trim is its centre, `largest` its ends."""
        turned = -steering if self.reversed else steering
        reach = self.largest - self.trim if turned >= 0.0 else self.largest + self.trim
        return clamp(self.trim + turned * reach, self.largest)


def linearize_thrust(throttle: float, curve: float) -> float:
    """Return the throttle 0..1 for a share of the thrust: ArduRover's MOT_THST_EXPO without its 0/0."""
    if curve == 0.0 or throttle == 0.0 or math.isnan(throttle):  # NaN stays NaN for the last gate
        return throttle
    root = math.sqrt(max(0.0, (1.0 - curve) ** 2 + 4.0 * curve * throttle))
    return min(1.0, 2.0 * throttle / (1.0 - curve + root))


def build_output_scaling(params: Params) -> list[OutputScaling]:
    """Return the scaling of each possible motor."""
    curve, found = params["MOT_THST_EXPO"], []
    for names in PARAM_NAMES:
        reversed_, smallest, largest, trim = [params[name] for name in names]
        found.append(OutputScaling(reversed_ != 0.0, smallest / 100, largest / 100, trim / 100, curve))
    return found


def is_unscaled(driven: int, each: Sequence[OutputScaling]) -> bool:
    """Return whether the value of each of `driven` motors is that of its wheel, because no parameter changes it."""
    return all(fit == OutputScaling() for fit in each[:driven])


def scale_outputs(wheels: Sequence[float], driven: int, each: Sequence[OutputScaling]) -> tuple[float, ...]:
    """Return the motor values; the first `driven` motors drive. Each is in -1..1 if its wheel value is."""
    pairs = enumerate(zip(wheels, each, strict=False))
    return tuple(
        [fit.scale_throttle(wheel) if at < driven else fit.scale_steering(wheel) for at, (wheel, fit) in pairs]
    )
