"""Slew rate of one motor: to the step, and the reported limits."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle.drive.slew import Slew, SlewLimits

LIMITS = SlewLimits(accel=2.5, decel=5.0)


def steps(slew: Slew, target: float, count: int, limits: SlewLimits = LIMITS, dt: float = 0.02) -> list[float]:
    return [slew.step(target, dt, limits) for _ in range(count)]


def test_the_ramp_uses_accel_and_decel() -> None:
    slew = Slew()
    assert steps(slew, 1.0, 2) == pytest.approx([0.05, 0.1])
    assert slew.limited
    steps(slew, 1.0, 30)
    assert slew.value == 1.0
    assert not slew.limited
    assert steps(slew, 0.0, 2) == pytest.approx([0.9, 0.8])


def test_the_ramp_ends_exactly_at_the_target() -> None:
    slew = Slew()
    steps(slew, 0.33, 50)
    assert slew.value == 0.33
    steps(slew, 0.0, 50)
    assert slew.value == 0.0


def test_reversing_decelerates_first() -> None:
    slew = Slew()
    steps(slew, 1.0, 30)
    down = steps(slew, -1.0, 10)
    assert down == pytest.approx([0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1, 0.0])
    assert steps(slew, -1.0, 1) == pytest.approx([-0.05])


def test_reverse_delay_waits_at_zero() -> None:
    limits = SlewLimits(accel=2.5, decel=100.0, reverse_delay=0.1)
    slew = Slew()
    steps(slew, 0.5, 20, limits)
    values = steps(slew, -0.5, 8, limits)
    assert values[0] == 0.0
    assert values[1:5] == [0.0] * 4
    assert values[6] < 0.0
    steps(slew, -0.5, 20, limits)
    assert not slew.waiting


def test_reverse_delay_does_not_delay_the_same_direction() -> None:
    limits = SlewLimits(accel=2.5, decel=100.0, reverse_delay=1.0)
    slew = Slew()
    steps(slew, 0.5, 20, limits)
    steps(slew, 0.0, 2, limits)
    assert steps(slew, 0.5, 1, limits)[0] > 0.0


def test_reset_zeroes_the_ramp_at_once() -> None:
    slew = Slew()
    steps(slew, 1.0, 30)
    slew.reset()
    assert slew.value == 0.0


@given(st.lists(st.tuples(st.floats(-1, 1), st.floats(0, 0.1)), max_size=50), st.floats(0, 0.3))
def test_the_ramp_respects_its_limits_and_full_scale(moves: list[tuple[float, float]], delay: float) -> None:
    slew = Slew()
    limits = SlewLimits(accel=2.5, decel=5.0, reverse_delay=delay)
    for target, dt in moves:
        before = slew.value
        after = slew.step(target, dt, limits)
        rate = 5.0 if abs(after) < abs(before) else 2.5
        assert abs(after - before) <= rate * dt + 2e-9
        assert -1 <= after <= 1
        assert before * after >= 0  # through zero only by stopping there


@given(st.floats(-1, 1))
def test_full_to_zero_within_the_time_the_stop_needs(value: float) -> None:
    slew = Slew()
    steps(slew, value, 60)
    steps(slew, 0.0, 20, SlewLimits(accel=2.5, decel=2.5))
    assert slew.value == pytest.approx(0.0, abs=1e-9)


SLOW = SlewLimits(accel=1.0, decel=2.0)
DELAYED = SlewLimits(accel=1.0, decel=2.0, reverse_delay=0.5)


def test_a_new_one_stands_and_may_go_either_way_at_once() -> None:
    for target in (1.0, -1.0):
        slew = Slew()
        assert (slew.value, slew.limited, slew.waiting) == (0.0, False, False)
        assert slew.step(target, 0.25, DELAYED) == target / 4
        assert not slew.waiting


def test_no_delay_is_the_default() -> None:
    assert SlewLimits(1.0, 2.0).reverse_delay == 0.0


@pytest.mark.parametrize("sign", [1, -1])
def test_up_down_and_exactly_there(sign: int) -> None:
    slew = Slew()
    assert slew.step(sign * 0.5, 0.25, SLOW) == sign * 0.25
    assert slew.limited
    assert slew.step(sign * 0.5, 0.25, SLOW) == sign * 0.5
    assert not slew.limited
    assert slew.step(sign * 0.5, 0.25, SLOW) == sign * 0.5
    assert not slew.limited
    assert slew.step(sign * 0.125, 0.125, SLOW) == sign * 0.25
    assert slew.limited
    assert slew.step(sign * 0.75, 0.25, SLOW) == sign * 0.5


def test_a_reversal_stops_at_zero_and_waits_there() -> None:
    slew = Slew()
    slew.step(0.25, 0.25, DELAYED)
    assert slew.step(-1.0, 0.125, DELAYED) == 0.0
    assert (slew.limited, slew.waiting) == (True, False)
    for _ in range(3):
        assert slew.step(-1.0, 0.125, DELAYED) == 0.0
        assert (slew.limited, slew.waiting) == (False, True)
    assert slew.step(-1.0, 0.125, DELAYED) == -0.125  # 0.5 s at zero
    assert (slew.limited, slew.waiting) == (True, False)


def test_nothing_waits_that_is_to_stand() -> None:
    slew = Slew()
    slew.step(0.25, 0.25, DELAYED)
    for _ in range(3):
        slew.step(0.0, 0.125, DELAYED)
        assert not slew.waiting


def test_the_rest_before_a_reversal_restarts_with_each_motion() -> None:
    slew = Slew()
    slew.step(0.25, 0.25, DELAYED)
    slew.step(0.0, 0.125, DELAYED)
    slew.step(0.0, 0.5, DELAYED)
    assert slew.step(-0.25, 0.25, DELAYED) == -0.25
    slew.step(0.0, 0.125, DELAYED)
    assert slew.step(0.25, 0.25, DELAYED) == 0.0
    assert slew.waiting
    assert slew.step(-0.25, 0.25, DELAYED) == -0.25  # the way it came from
    assert not slew.waiting


def test_a_rounding_error_is_no_cycle() -> None:
    slew = Slew()
    assert slew.step(0.25 + 0.9e-9, 0.25, SLOW) == 0.25 + 0.9e-9
    assert not slew.limited
    slew = Slew()
    assert slew.step(0.25 + 2e-9, 0.25, SLOW) == 0.25
    assert slew.limited


def test_a_reset_stands_at_once_and_tells_nothing() -> None:
    slew = Slew()
    slew.step(1.0, 0.25, SLOW)
    assert slew.limited
    slew.reset()
    assert (slew.value, slew.limited, slew.waiting) == (0.0, False, False)
    slew.step(0.25, 0.25, DELAYED)
    slew.step(-1.0, 0.125, DELAYED)
    slew.step(-1.0, 0.125, DELAYED)
    assert slew.waiting
    slew.reset()
    assert (slew.value, slew.limited, slew.waiting) == (0.0, False, False)


def test_a_nan_stays_none_and_is_not_reported_as_waiting() -> None:
    slew = Slew()
    slew.step(0.25, 0.25, DELAYED)
    slew.step(-1.0, 0.125, DELAYED)
    slew.step(-1.0, 0.125, DELAYED)
    assert slew.waiting
    assert math.isnan(slew.step(math.nan, 0.125, DELAYED))
    assert math.isnan(slew.value)
    assert not slew.waiting
