"""How long a mission takes."""

from __future__ import annotations

import pytest

from groundstation.ui.map.plan.plan_time import LegTime, clock_text, leg_times, seconds_of
from tests.groundstation.ui.map.plans import item, task

POINTS = [(10.0, 0.0), (10.0, 20.0)]


def test_ways_take_their_length_at_the_speed_that_holds() -> None:
    mission = (item(16, 10, 0), task(178, 1.0, 2.0), item(16, 10, 20))
    legs = leg_times(mission, (0, 2), 0.5)
    assert legs == (LegTime(0.5, 0.0), LegTime(2.0, 0.0))
    assert seconds_of((0.0, 0.0), POINTS, legs) == pytest.approx(10 / 0.5 + 20 / 2.0)
    assert seconds_of(None, POINTS, legs) == pytest.approx(20 / 2.0), "without a home the first place is the start"


@pytest.mark.parametrize(("asked", "then"), [(-1.0, 2.0), (-2.0, 0.5), (0.0, 2.0), (float("nan"), 2.0)])
def test_a_speed_below_zero_keeps_or_restores_the_speed(asked: float, then: float) -> None:
    mission = (task(178, 1.0, 2.0), item(16, 10, 0), task(178, 1.0, asked), item(16, 10, 20))
    assert leg_times(mission, (1, 3), 0.5) == (LegTime(2.0, 0.0), LegTime(then, 0.0))


def test_waits_and_circles_count_and_a_stay_has_no_end() -> None:
    mission = (item(16, 10, 0, 3.0), task(93, 4.0), item(19, 10, 20, 10.0))
    assert leg_times(mission, (0, 2), 1.0) == (LegTime(1.0, 3.0), LegTime(1.0, 14.0))
    circle = leg_times((item(18, 10, 0, 2.0),), (0,), 1.0)
    assert circle == (LegTime(1.0, 0.0),), "no radius: the vehicle's own, which is not known here"
    stay = leg_times((item(17, 10, 0),), (0,), 1.0)
    assert stay is not None
    assert seconds_of((0.0, 0.0), POINTS[:1], stay) is None


def test_without_a_speed_there_is_no_time() -> None:
    assert leg_times((item(16, 10, 0),), (0,), None) is None
    assert leg_times((task(178, 1.0, 2.0), item(16, 10, 0)), (1,), None) == (LegTime(2.0, 0.0),)


def test_times_are_written_as_a_clock_does() -> None:
    assert [clock_text(seconds) for seconds in (0, 59.6, 492, 3725)] == ["0:00", "1:00", "8:12", "1:02:05"]
