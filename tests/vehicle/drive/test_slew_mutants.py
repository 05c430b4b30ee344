"""One ramp: to the step, and what is reported of it."""

from __future__ import annotations

import math

import pytest

from vehicle.drive.slew import Slew, SlewLimits

LIMITS = SlewLimits(accel=1.0, decel=2.0)
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
    assert slew.step(sign * 0.5, 0.25, LIMITS) == sign * 0.25
    assert slew.limited
    assert slew.step(sign * 0.5, 0.25, LIMITS) == sign * 0.5
    assert not slew.limited
    assert slew.step(sign * 0.5, 0.25, LIMITS) == sign * 0.5
    assert not slew.limited
    assert slew.step(sign * 0.125, 0.125, LIMITS) == sign * 0.25
    assert slew.limited
    assert slew.step(sign * 0.75, 0.25, LIMITS) == sign * 0.5


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
    assert slew.step(0.25 + 0.9e-9, 0.25, LIMITS) == 0.25 + 0.9e-9
    assert not slew.limited
    slew = Slew()
    assert slew.step(0.25 + 2e-9, 0.25, LIMITS) == 0.25
    assert slew.limited


def test_a_reset_stands_at_once_and_tells_nothing() -> None:
    slew = Slew()
    slew.step(1.0, 0.25, LIMITS)
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
