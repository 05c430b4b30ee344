"""Mixers: throttle, steering and sideways to one value for each motor, without ramps.

To add a wheel arrangement, write a function (throttle, steering, sideways, limit) -> values and a row in MIXERS.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import msgspec

from dialects.enums import DriveType


class MixerOutput(NamedTuple):
    """Motor values -1..1 in motor order, and whether the demand had to be reduced to fit."""

    throttles: tuple[float, ...]
    saturated: bool = False


class MixerLimits(NamedTuple):
    """What decides if not everything fits (MOT_STR_THR_MIX, MOT_THST_ASYM)."""

    mix: float = 0.5
    """0.5 reduces throttle and steering alike, 1 keeps all of the steering."""
    asymmetry: float = 1.0
    """Thrust of a motor forward in relation to its thrust backward, at least 1."""


class Mixer(msgspec.Struct, frozen=True):
    """How a wheel arrangement is driven."""

    mix: Callable[[float, float, float, MixerLimits], MixerOutput]
    motors: tuple[str, ...]
    servos: tuple[int, ...]
    """Servo output (1..16) of each motor in SERVO_OUTPUT_RAW: ArduRover's default wiring."""
    sideways: bool = False
    """The drive can move sideways without turning."""

    @property
    def driven_count(self) -> int:
        """Number of motors, the first ones, that turn wheels; a steering servo does not."""
        return sum(motor != "steering" for motor in self.motors)


def skid(throttle: float, steering: float, sideways: float, limit: MixerLimits) -> MixerOutput:
    """Mix for skid steering: left, right. Steering is positive clockwise.

    ArduRover's rule (AP_MotorsUGV::output_skid_steering): a motor with less thrust backward gets a larger value there,
    so that throttle ends at -1/asymmetry. What does not fit is divided by `mix`.
    """
    if limit.asymmetry == 1.0 and abs(throttle) + abs(steering) <= 1.0:  # all fits: nothing below changes it
        return MixerOutput((throttle + steering, throttle - steering))
    lowest = -1.0 / limit.asymmetry
    best = (1.0 + lowest) / 2  # throttle with most room for steering
    room = 1.0 - best if throttle >= best else max(throttle, 0.0) - lowest
    limited = clamp(steering, room), max(throttle, lowest) if throttle < 0.0 else throttle
    steer, push = limited
    excess = max(push + abs(steer), (push - abs(steer)) / lowest)
    if excess > 1.0:
        steer, push = _shared(steer, push, excess, lowest, best, limit.mix)
    sides = _strengthened(push + steer, limit.asymmetry), _strengthened(push - steer, limit.asymmetry)
    return MixerOutput(sides, saturated=excess > 1.0 or limited != (steering, throttle))


def _shared(
    steer: float, push: float, excess: float, lowest: float, best: float, mix: float
) -> tuple[float, float]:  # fmt: skip
    """Return steering and throttle reduced so that they fit together."""
    fair, weight = 1.0 / excess, abs(mix - 0.5) / 0.5
    keep = fair + (1.0 - fair) * weight
    if mix >= 0.5:
        steer *= keep
        return steer, 1.0 - abs(steer) if push >= best else lowest + abs(steer)
    push *= keep
    return math.copysign(1.0 - push if push >= best else push - lowest, steer), push


def _strengthened(side: float, asymmetry: float) -> float:
    return _unit(side * asymmetry if side < 0.0 else side)


def ackermann(throttle: float, steering: float, sideways: float, limit: MixerLimits) -> MixerOutput:
    """Mix for a car: throttle and steering servo are independent."""
    return MixerOutput((throttle, steering))


FOUR_WHEELS: tuple[tuple[int, int, int], ...] = ((1, 1, 1), (1, -1, -1), (1, 1, -1), (1, -1, 1))
"""Factors of throttle, steering and sideways for front left, front right, rear left and rear right: ArduRover's
(AP_MotorsUGV::setup_omni, OMNIX and mecanum) in our order. Seen from above, the axles of omni wheels and the rollers
of mecanum wheels form an X."""


def four_wheels(throttle: float, steering: float, sideways: float, limit: MixerLimits) -> MixerOutput:
    """Mix for omni and mecanum wheels; beyond the limit all wheels are scaled alike to keep the direction."""
    sums = [throttle * ahead + steering * turn + sideways * side for ahead, turn, side in FOUR_WHEELS]
    largest = max(1.0, *(abs(each) for each in sums))
    return MixerOutput(tuple(_unit(each / largest) for each in sums), saturated=largest > 1.0)


def _unit(value: float) -> float:
    """Clamp to -1..1: rounding may end at 1.0000000000000002, which the gate would reject."""
    return clamp(value, 1.0)


def clamp(value: float, largest: float) -> float:
    """Return `value` within -largest..largest. NaN stays NaN for the gate; min() would make it full speed."""
    if value > largest:
        return largest
    return -largest if value < -largest else value


def pivot_scale(throttle: float, steering: float, sideways: float, pivot: float) -> float:
    """Return the share of the motor values to keep: 1 without a turn, `pivot` for a turn on the spot.

    MOT_PIVOT_MAX, for drives that turn by their wheels: on the spot the wheels skid, which takes much power.
    """
    turn, travel = abs(steering), abs(throttle) + abs(sideways)
    return (travel + pivot * turn) / (travel + turn) if travel + turn else 1.0


CORNERS = ("front left", "front right", "rear left", "rear right")

MIXERS: dict[DriveType, Mixer] = {
    DriveType.SKID: Mixer(skid, ("left", "right"), (1, 3)),
    DriveType.ACKERMANN: Mixer(ackermann, ("throttle", "steering"), (3, 1)),
    DriveType.OMNI: Mixer(four_wheels, CORNERS, (4, 1, 3, 2), sideways=True),
    DriveType.MECANUM: Mixer(four_wheels, CORNERS, (4, 1, 3, 2), sideways=True),
}
"""DRIVE_TYPE -> mixer."""


def expo(value: float, softness: float) -> float:
    """Return `value` softened around neutral: ArduRover's MANUAL_STR_EXPO curve.

    (1-e) x / (1 - e |x|), 0 <= e < 1; full stays full.
    """
    return (1.0 - softness) * value / (1.0 - softness * abs(value))


def deadband(value: float, band: float) -> float:
    """Return 0 within `band` of neutral; from there on the value rises without a step to full."""
    if abs(value) <= band:
        return 0.0
    return math.copysign((abs(value) - band) / (1.0 - band), value)
