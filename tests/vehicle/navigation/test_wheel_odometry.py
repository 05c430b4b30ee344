"""Wheel odometry: sideways speed of wheels that can slide, and the scale."""

from __future__ import annotations

import math

import pytest

from vehicle.navigation.wheel_odometry import SCALE_MAX, WheelOdometry
from vehicle.readings import Readings

MECANUM = (1, -1, -1, 1)


@pytest.mark.parametrize("speed", [None, math.nan, math.inf, 51.0, -51.0])
def test_an_impossible_speed_is_missing(speed: float | None) -> None:
    assert WheelOdometry().speed(Readings(speed=speed)) is None


def test_only_a_drive_that_can_slide_moves_sideways() -> None:
    sliding = Readings(wheel_speeds=(0.5, -0.5, -0.5, 0.5))
    assert WheelOdometry(MECANUM).sideways_speed(sliding) == pytest.approx(0.5)
    assert WheelOdometry().sideways_speed(sliding) == 0.0


def test_sideways_speed_takes_an_encoder_on_each_wheel() -> None:
    assert WheelOdometry(MECANUM).sideways_speed(Readings(wheel_speeds=(0.5, 0.5))) is None


def test_the_scale_approaches_the_gps_speed_and_stays_limited() -> None:
    odometry = WheelOdometry()
    first = odometry.update_scale(1.1, 1.0, 0.2)
    assert 1.0 < first < 1.01
    for _ in range(5000):
        odometry.update_scale(2.0, 1.0, 0.2)
    assert odometry.speed(Readings(speed=1.0)) == pytest.approx(1.0 + SCALE_MAX)
