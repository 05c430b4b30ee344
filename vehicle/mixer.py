"""Throttle, steering and sideways -> one value for each motor; no ramps and no limits in time.

To add an arrangement of wheels, write a function (throttle, steering, mix, sideways) -> values and a line in MIXERS.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from dialects.enums import DriveType


@dataclass(frozen=True, slots=True)
class Mixed:
    """Motor values -1..1 in motor order, and whether the demand had to be cut to fit."""

    throttles: tuple[float, ...]
    saturated: bool = False


@dataclass(frozen=True, slots=True)
class Mixer:
    """How one arrangement of wheels is driven."""

    mix: Callable[[float, float, float, float], Mixed]
    motors: tuple[str, ...]
    servos: tuple[int, ...]
    """Servo output (1..16) of each motor in SERVO_OUTPUT_RAW: ArduRover's default wiring."""
    sideways: bool = False
    """It can move to the side without turning."""

    @property
    def driven(self) -> int:
        """Motors, the first ones, that turn wheels; a steering servo does not."""
        return sum(motor != "steering" for motor in self.motors)


def skid(throttle: float, steering: float, mix: float, sideways: float = 0.0) -> Mixed:
    """Left, right. Beyond the limit `mix` (MOT_STR_THR_MIX) shares what there is: 0.5 cuts both, 1 keeps steering.

    ArduRover's rule (AP_MotorsUGV::output_skid_steering) with equal thrust both ways. Steering is clockwise positive.
    """
    sum_ = abs(throttle) + abs(steering)
    if sum_ <= 1.0:
        return Mixed((throttle + steering, throttle - steering))
    fair = 1.0 / sum_
    if mix >= 0.5:
        steering *= fair + (1.0 - fair) * (mix - 0.5) / 0.5
        throttle = math.copysign(1.0 - abs(steering), throttle)
    else:
        throttle *= fair + (1.0 - fair) * (0.5 - mix) / 0.5
        steering = math.copysign(1.0 - abs(throttle), steering)
    return Mixed((_unit(throttle + steering), _unit(throttle - steering)), saturated=True)


def ackermann(throttle: float, steering: float, mix: float, sideways: float = 0.0) -> Mixed:
    """Throttle and steering servo, apart, as in a car."""
    return Mixed((throttle, steering))


FOUR_WHEELS: tuple[tuple[int, int, int], ...] = ((1, 1, 1), (1, -1, -1), (1, 1, -1), (1, -1, 1))
"""What throttle, steering and sideways give to front left, front right, rear left and rear right: ArduRover's factors
(AP_MotorsUGV::setup_omni, OMNIX and mecanum) in our order. Seen from above, the axles of omni wheels and the rollers of
mecanum wheels form an X."""


def four_wheels(throttle: float, steering: float, mix: float, sideways: float = 0.0) -> Mixed:
    """Each wheel its sum; beyond the limit all are cut by the same factor, so that the direction stays."""
    sums = [throttle * ahead + steering * turn + sideways * side for ahead, turn, side in FOUR_WHEELS]
    largest = max(1.0, *(abs(each) for each in sums))
    return Mixed(tuple(_unit(each / largest) for each in sums), saturated=largest > 1.0)


def _unit(value: float) -> float:
    """Rounding may end at 1.0000000000000002, which the gate would refuse."""
    return clamp(value, 1.0)


def clamp(value: float, largest: float) -> float:
    """`value` within -largest..largest. NaN stays NaN, for the gate to see: min() would make it full speed."""
    if value > largest:
        return largest
    return -largest if value < -largest else value


CORNERS = ("front left", "front right", "rear left", "rear right")

MIXERS: dict[DriveType, Mixer] = {
    DriveType.SKID: Mixer(skid, ("left", "right"), (1, 3)),
    DriveType.ACKERMANN: Mixer(ackermann, ("throttle", "steering"), (3, 1)),
    DriveType.OMNI: Mixer(four_wheels, CORNERS, (4, 1, 3, 2), sideways=True),
    DriveType.MECANUM: Mixer(four_wheels, CORNERS, (4, 1, 3, 2), sideways=True),
}
"""DRIVE_TYPE -> mixer."""


def expo(value: float, softness: float) -> float:
    """Less around neutral, full at full: ArduRover's MANUAL_STR_EXPO curve, (1-e) x / (1 - e |x|), 0 <= e < 1."""
    return (1.0 - softness) * value / (1.0 - softness * abs(value))


def deadband(value: float, band: float) -> float:
    """0 within `band` of neutral, and from there on without a step to full."""
    if abs(value) <= band:
        return 0.0
    return math.copysign((abs(value) - band) / (1.0 - band), value)
