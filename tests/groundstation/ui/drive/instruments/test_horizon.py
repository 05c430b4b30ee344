"""The artificial horizon."""

from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from groundstation.ui.drive.instruments.horizon import Horizon, HorizonValue, ground_fraction
from tests.groundstation.ui.frames import texts


def test_level_is_half_ground() -> None:
    level = HorizonValue(0.0, 0.0)
    assert [ground_fraction(level, 0, row, 4) for row in range(4)] == [0.0, 0.0, 1.0, 1.0]


def test_nose_up_shows_sky_and_right_down_lifts_right_horizon() -> None:
    up, right = HorizonValue(0.0, 0.2), HorizonValue(0.3, 0.0)
    assert ground_fraction(up, 0, 2, 4) < 1.0
    assert ground_fraction(right, 8, 1, 4) > ground_fraction(right, -8, 1, 4)


@given(st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi))
def test_the_horizon_fills_its_place_at_any_attitude(roll: float, pitch: float) -> None:
    assert all(len(line) == 22 for line in texts(Horizon(HorizonValue(roll, pitch)).draw(22, 5)))
