"""Mixers: the value of each wheel, and when it counts as cut."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dialects.enums import DriveType
from vehicle.drive.mixer import (
    MIXERS,
    MixerLimits,
    MixerOutput,
    ackermann,
    clamp,
    deadband,
    expo,
    four_wheels,
    pivot_scale,
    skid,
)
from vehicle.params import PARAMETERS

UNIT = st.floats(-1, 1)
FAIR = MixerLimits()
LIMITS = st.builds(MixerLimits, st.floats(0.2, 1), st.floats(1, 10))


@pytest.mark.parametrize(
    ("throttle", "steering", "left", "right"),
    [(1, 0, 1, 1), (-1, 0, -1, -1), (0, 1, 1, -1), (0, -1, -1, 1), (0.5, 0.25, 0.75, 0.25), (-0.5, 0.25, -0.25, -0.75)],
)
def test_skid_adds_and_subtracts(throttle: float, steering: float, left: float, right: float) -> None:
    mixed = skid(throttle, steering, 0.0, FAIR)
    assert mixed.throttles == (left, right)
    assert not mixed.saturated


def test_saturated_skid_reduces_both_alike_by_default() -> None:
    mixed = skid(1.0, 1.0, 0.0, FAIR)
    assert mixed.throttles == pytest.approx((1.0, 0.0))
    assert mixed.saturated


def test_skid_can_keep_all_of_the_steering() -> None:
    assert skid(1.0, 0.8, 0.0, MixerLimits(mix=1.0)).throttles == pytest.approx((1.0, -0.6))


def test_skid_can_keep_more_of_the_throttle() -> None:
    left, right = skid(1.0, 1.0, 0.0, MixerLimits(mix=0.2)).throttles
    assert left == pytest.approx(1.0)
    assert right > 0.5


def test_reverse_keeps_the_sense_of_turning() -> None:
    left, right = skid(-1.0, 0.5, 0.0, FAIR).throttles
    assert left > right  # clockwise, whichever way it rolls


def reference(throttle: float, steering: float, mix: float, asymmetry: float) -> tuple[float, float]:
    """ArduRover's saturation rule (AP_MotorsUGV::output_skid_steering), step by step."""
    lowest = -1 / asymmetry
    best = (1 + lowest) / 2
    room = 1 - best if throttle >= best else max(throttle, 0) - lowest
    steering, throttle = max(-room, min(room, steering)), max(lowest, throttle)
    saturation = max(throttle + abs(steering), (throttle - abs(steering)) / lowest)
    if saturation > 1:
        if mix >= 0.5:
            steering *= (1 / saturation) * (1 - mix) / 0.5 + (mix - 0.5) / 0.5
            throttle = 1 - abs(steering) if throttle >= best else lowest + abs(steering)
        else:
            throttle *= (1 / saturation) * mix / 0.5 + (0.5 - mix) / 0.5
            sign = 1 if steering > 0 else -1
            steering = sign * (1 - throttle if throttle >= best else throttle - lowest)
    left, right = (side * asymmetry if side < 0 else side for side in (throttle + steering, throttle - steering))
    return left, right


@given(UNIT, UNIT, LIMITS)
def test_skid_saturates_as_ardurover_does(throttle: float, steering: float, limit: MixerLimits) -> None:
    found = skid(throttle, steering, 0.0, limit).throttles
    assert found == pytest.approx(reference(throttle, steering, limit.mix, limit.asymmetry), abs=1e-9)


@pytest.mark.parametrize(
    ("throttle", "steering", "wheels"),
    [
        (1.0, 0.0, (1.0, 1.0)),
        (-0.25, 0.0, (-0.5, -0.5)),  # twice as much for the same push
        (-1.0, 0.0, (-1.0, -1.0)),  # half of the push ahead is all there is
        (0.0, 0.25, (0.25, -0.5)),
        (0.0, 1.0, (0.5, -1.0)),
        (1.0, 1.0, (1.0, 1 / 7)),
    ],
)
def test_motors_with_half_the_thrust_backward(
    throttle: float, steering: float, wheels: tuple[float, float]
) -> None:  # fmt: skip
    mixed = skid(throttle, steering, 0.0, MixerLimits(asymmetry=2.0))
    assert mixed.throttles == pytest.approx(wheels)
    assert mixed.saturated == (throttle == -1.0 or steering == 1.0)


@pytest.mark.parametrize(
    ("demand", "share"),
    [((1.0, 0.0, 0.0), 1.0), ((0.0, 1.0, 0.0), 0.4), ((0.0, -0.1, 0.0), 0.4), ((0.5, 0.5, 0.0), 0.7),
     ((0.25, 0.5, -0.25), 0.7), ((0.0, 0.0, 1.0), 1.0), ((0.0, 0.0, 0.0), 1.0)],
)  # fmt: skip
def test_pivot_scale_reduces_turns_on_the_spot(demand: tuple[float, float, float], share: float) -> None:
    assert pivot_scale(*demand, 0.4) == pytest.approx(share)


def test_ackermann_keeps_throttle_and_steering_apart() -> None:
    assert ackermann(0.3, -1.0, 0.0, FAIR).throttles == (0.3, -1.0)


@pytest.mark.parametrize(
    ("demand", "wheels"),
    [
        ((1.0, 0.0, 0.0), (1, 1, 1, 1)),
        ((0.0, 1.0, 0.0), (1, -1, 1, -1)),  # clockwise: the left wheels ahead
        ((0.0, 0.0, 1.0), (1, -1, -1, 1)),  # to the right: the wheels of each side against each other
        ((-0.5, 0.0, 0.25), (-0.25, -0.75, -0.75, -0.25)),
    ],
)
def test_four_wheels_go_ahead_turn_and_slide(demand: tuple[float, float, float], wheels: tuple[float, ...]) -> None:
    throttle, steering, sideways = demand
    mixed = four_wheels(throttle, steering, sideways, FAIR)
    assert mixed.throttles == wheels
    assert not mixed.saturated


def test_saturated_four_wheels_keep_the_direction() -> None:
    mixed = four_wheels(1.0, 0.5, 0.5, FAIR)
    assert mixed.throttles == pytest.approx((1.0, 0.0, 0.5, 0.5))
    assert mixed.saturated


@pytest.mark.parametrize("place", [0, 1, 2])
def test_nan_stays_nan(place: int) -> None:
    """The gate must see it."""
    demand = [0.5, 0.5, 0.5]
    demand[place] = math.nan
    throttle, steering, sideways = demand
    assert all(map(math.isnan, four_wheels(throttle, steering, sideways, FAIR).throttles))
    if place < 2:
        assert all(map(math.isnan, skid(throttle, steering, 0.0, FAIR).throttles))
    assert math.isnan(pivot_scale(throttle, steering, sideways, 0.4))


@given(UNIT, UNIT, UNIT, LIMITS, st.sampled_from(sorted(MIXERS)))
def test_every_mixer_stays_within_full_scale(
    throttle: float, steering: float, sideways: float, limit: MixerLimits, kind: DriveType
) -> None:
    mixer = MIXERS[kind]
    values = mixer.mix(throttle, steering, sideways, limit).throttles
    assert len(values) == len(mixer.motors) == len(mixer.servos)
    assert all(-1 <= value <= 1 for value in values)


@given(LIMITS)
def test_a_neutral_demand_gives_zero(limit: MixerLimits) -> None:
    for mixer in MIXERS.values():
        assert not any(mixer.mix(0.0, 0.0, 0.0, limit).throttles)


def test_every_drive_type_that_can_be_set_has_a_mixer() -> None:
    drive_type = PARAMETERS["DRIVE_TYPE"]
    assert set(MIXERS) == set(range(int(drive_type.low), int(drive_type.high) + 1))


@given(UNIT, st.floats(0, 0.9))
def test_expo_softens_and_keeps_the_ends(value: float, softness: float) -> None:
    assert abs(expo(value, softness)) <= abs(value) + 1e-12
    assert expo(math.copysign(1, value), softness) == pytest.approx(math.copysign(1, value))


def test_deadband_has_no_step() -> None:
    assert deadband(0.03, 0.03) == 0
    assert deadband(0.031, 0.03) == pytest.approx(0.001 / 0.97)
    assert deadband(-1.0, 0.03) == -1.0


def test_limits_cut_alike_and_allow_equal_reverse_by_default() -> None:
    assert MixerLimits() == (0.5, 1.0)
    assert not MixerOutput((0.0,)).saturated


def test_a_sum_beyond_full_is_reported_as_cut() -> None:
    assert four_wheels(1.0, 0.0, 0.0, MixerLimits()) == MixerOutput((1.0,) * 4, saturated=False)
    assert four_wheels(1.0, 0.25, 0.0, MixerLimits()) == MixerOutput((1.0, 0.6, 1.0, 0.6), saturated=True)
    assert four_wheels(0.25, 0.25, 0.75, MixerLimits()).saturated
    assert skid(1.0, 0.001, 0.0, MixerLimits()).saturated
    assert not skid(1.0, 0.0, 0.0, MixerLimits()).saturated
    assert not skid(0.5, 0.5, 0.0, MixerLimits()).saturated


def test_sums_that_round_beyond_full_are_full() -> None:
    assert skid(0.68, -0.95, 0.0, MixerLimits(1.0, 1.2)).throttles == (-1.0, 1.0)


@pytest.mark.parametrize(("value", "found"), [(0.5, 0.5), (0.6, 0.5), (-0.5, -0.5), (-0.6, -0.5), (0.1, 0.1)])
def test_clamp(value: float, found: float) -> None:
    assert clamp(value, 0.5) == found


def test_wiring_and_abilities_of_each_drive() -> None:
    """ArduRover's default servo outputs, in the order of the motors."""
    assert {
        kind: (mixer.motors, mixer.servos, mixer.sideways, mixer.driven_count) for kind, mixer in MIXERS.items()
    } == {
        DriveType.SKID: (("left", "right"), (1, 3), False, 2),
        DriveType.ACKERMANN: (("throttle", "steering"), (3, 1), False, 1),
        DriveType.OMNI: (("front left", "front right", "rear left", "rear right"), (4, 1, 3, 2), True, 4),
        DriveType.MECANUM: (("front left", "front right", "rear left", "rear right"), (4, 1, 3, 2), True, 4),
    }
