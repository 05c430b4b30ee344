"""Slew rate of one motor."""

from __future__ import annotations

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
