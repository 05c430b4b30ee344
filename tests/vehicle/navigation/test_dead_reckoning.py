"""Dead reckoning: steps, fixes, and corrections of the distance already driven."""

from __future__ import annotations

import math

import pytest

from vehicle.navigation.dead_reckoning import AveragingGain, DeadReckoning


def driven(yaw: float = 0.0, scale: float = 1.0) -> DeadReckoning:
    """40 m in steps of a control cycle."""
    reckoning = DeadReckoning()
    for _ in range(2500):
        reckoning.advance(0.016 * scale, yaw)
    return reckoning


def test_steps_add_up_along_the_yaw() -> None:
    assert driven(math.pi / 2).place == pytest.approx((0.0, 40.0), abs=1e-9)


def test_a_heading_correction_turns_the_distance_already_driven() -> None:
    reckoning = driven(yaw=0.02)
    reckoning.correct_heading(-0.02)
    assert reckoning.place == pytest.approx((40.0, 0.0), abs=0.02)


def test_scale_correction_stretches_the_distance_already_driven() -> None:
    reckoning = driven(scale=1.02)
    reckoning.correct_scale(1 / 1.02)
    assert reckoning.place == pytest.approx((40.0, 0.0))


@pytest.mark.parametrize(("believed", "left"), [(1.0, 0.0), (0.5, 0.4), (0.0, 0.8)])
def test_the_part_replaced_by_a_fix_is_not_corrected(believed: float, left: float) -> None:
    reckoning = driven()
    reckoning.correct_position(0.0, 0.0, believed)
    reckoning.correct_heading(0.02)
    assert reckoning.place == pytest.approx((40.0, left))


def test_a_fix_moves_the_position_by_its_gain() -> None:
    reckoning = driven()
    reckoning.correct_position(1.0, -2.0, 0.25)
    assert reckoning.place == pytest.approx((40.25, -0.5))


def test_a_gain_starts_as_a_mean_and_settles() -> None:
    gain = AveragingGain(10.0)
    gains = [gain.next(1.0) for _ in range(50)]
    assert gains[:3] == pytest.approx([1.0, 1 / 2, 1 / 3])
    assert gains[-1] == pytest.approx(1 / 11)


def test_credit_reduces_the_first_gain() -> None:
    assert AveragingGain(10.0, credit=4).next(0.1) == pytest.approx(1 / 5)
