"""NAV items and CONDITION_YAW in a simulated field with noisy sensors."""

from __future__ import annotations

import math

from dialects.enums import Command
from dialects.modes import Mode
from tests.vehicle.missions import do, finish, ready, start, way
from vehicle.navigation.geo import Point


def test_the_rover_stands_at_a_waypoint_with_a_hold_time() -> None:
    field = ready(way(5, 0, 4.0), way(5, 5))
    start(field)
    field.until(Point(5, 0), 20.0, 0.5)
    field.beat(2.0)
    assert field.stands_for(2.0)
    finish(field, 40.0)
    assert field.truth.distance(Point(5, 5)) < 0.7


def test_turns_around_a_point() -> None:
    field = ready((Command.NAV_LOITER_TURNS, Point(6, 0), (1.5, 0, 2.0)))
    field.track.clear()
    start(field)
    finish(field, 120.0)
    near = [place.distance(Point(6, 0)) for place in field.track[len(field.track) // 2 :]]
    assert min(near) > 1.2
    assert max(near) < 2.8


def test_condition_yaw_and_set_reverse() -> None:
    field = ready(do(Command.CONDITION_YAW, 180.0), do(Command.DO_SET_REVERSE, 1), way(6, 0))
    start(field)
    finish(field, 60.0)
    assert abs(abs(math.remainder(field.yaw, math.tau)) - math.pi) < 0.3
    assert field.truth.distance(Point(6, 0)) < 0.7


def test_loiter_time_stands_at_the_place() -> None:
    field = ready((Command.NAV_LOITER_TIME, Point(4, 0), (5.0,)), way(8, 0))
    start(field)
    field.until(Point(4, 0), 30.0, 0.4)
    field.beat(1.5)
    assert field.stands_for(2.0)
    finish(field, 40.0)
    assert field.truth.distance(Point(8, 0)) < 0.7


def test_loiter_unlimited_stays_until_the_mode_changes() -> None:
    field = ready((Command.NAV_LOITER_UNLIM, Point(3, 0), ()), way(30, 0))
    start(field)
    field.beat(60.0)
    assert field.mode is Mode.AUTO
    assert field.truth.distance(Point(3, 0)) < 0.7
