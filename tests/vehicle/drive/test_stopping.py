"""The way to a standstill, and the speed that it allows."""

from __future__ import annotations

import math

import pytest

from vehicle.drive.stopping import Stopping
from vehicle.params import Params


@pytest.mark.parametrize("slowest", [0.0, 0.5])
@pytest.mark.parametrize("distance", [0.01, 0.5, 3.0])
def test_from_the_speed_within_a_distance_it_stops_there(slowest: float, distance: float) -> None:
    stopping = Stopping.of(Params(), slowest)
    assert stopping.distance(stopping.speed_within(distance)) == pytest.approx(distance)


@pytest.mark.parametrize("distance", [0.0, -1.0, math.nan])
def test_without_room_there_is_no_speed(distance: float) -> None:
    assert Stopping.of(Params()).speed_within(distance) == 0.0


def test_a_slower_ramp_needs_more_room() -> None:
    assert Stopping.of(Params(), 0.5).distance(1.0) > Stopping.of(Params()).distance(1.0)
