"""What is told of the way: targets on the globe and on the ground, the path, the fence; in a simulated field."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.enums import FenceItem, MissionType, Result
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, NEUTRAL
from tests.vehicle.field import ONLY_PLACE, Field
from tests.vehicle.missions import ready, start, upload, way
from vehicle.navigation.geo import Point


def test_a_mission_tells_course_distance_and_error() -> None:
    field = ready(way(20, 0), way(20, 20))
    start(field)
    field.until(Point(10, 0), 60.0)
    field.wait(0.6)
    told = field.newest(m.NavControllerOutput)
    assert told.wp_dist == pytest.approx(20.0 - field.truth.north, abs=2.0)
    assert abs(told.target_bearing) < 10
    assert abs(told.nav_bearing) < 20
    assert told.xtrack_error == pytest.approx(field.truth.east, abs=1.0)
    assert abs(told.aspd_error) < 0.3
    field.until(Point(20, 10), 60.0)
    field.wait(0.6)
    assert field.newest(m.NavControllerOutput).target_bearing == pytest.approx(90, abs=12)


def test_beside_the_line_the_error_says_on_which_side() -> None:
    field = Field()
    field.begin(Mode.GUIDED)
    field.goto(20.0, 0.0)
    field.until(Point(5, 0), 60.0)
    assert field.body is not None
    field.body.motion.east += 5.0  # somebody carries it to the right
    field.wait(4.0)
    assert max(told.xtrack_error for told in field.all(m.NavControllerOutput)[-4:]) > 0.3


def test_a_driver_at_the_sticks_is_told_nothing_of_it() -> None:
    field = Field()
    field.arm()
    field.wait(0.2, NEUTRAL)
    field.wait(2.0, AHEAD)
    assert field.turning
    for kind in (m.NavControllerOutput, m.PositionTargetLocalNed, m.PositionTargetGlobalInt, m.FenceStatus):
        assert not field.all(kind)


def test_a_place_is_told_on_the_ground_and_on_the_globe() -> None:
    field = Field()
    field.begin(Mode.GUIDED)
    field.goto(8.0, -3.0)
    field.wait(0.1)
    told = field.newest(m.PositionTargetLocalNed)
    assert (told.coordinate_frame, told.type_mask) == (1, ONLY_PLACE)
    assert [told.x, told.y] == pytest.approx([8.0, -3.0])
    assert field.newest(m.PositionTargetGlobalInt).lat_int > 500000000


def test_a_velocity_is_told_while_it_counts() -> None:
    field = Field()
    field.begin(Mode.GUIDED)
    field.stream(3.0, 0.5, 0.25)
    told = field.newest(m.PositionTargetLocalNed)
    assert (told.coordinate_frame, told.type_mask) == (8, 0x5C7)
    assert [told.vx, told.yaw_rate] == pytest.approx([0.5, 0.25])
    assert field.newest(m.NavControllerOutput).wp_dist == 0
    field.wait(1.5)  # GUIDED_TIMEOUT
    before = len(field.all(m.PositionTargetLocalNed))
    field.wait(2.0)
    assert len(field.all(m.PositionTargetLocalNed)) == before


def test_a_velocity_toward_a_heading_is_told_over_ground() -> None:
    field = Field()
    field.begin(Mode.GUIDED)
    only_velocity = 0xDC7
    for _ in range(30):
        field.say(m.SetPositionTargetLocalNed(0, 1, 1, 1, only_velocity, 0, 0, 0, 0.3, 0.4, 0, 0, 0, 0, 0, 0))
        field.wait(0.06)
    told = field.newest(m.PositionTargetLocalNed)
    assert (told.coordinate_frame, told.type_mask) == (1, 0x9C7)
    assert [told.vx, told.vy] == pytest.approx([0.3, 0.4])
    assert told.yaw == pytest.approx(math.atan2(0.4, 0.3))


def test_the_fence_tells_of_itself_while_it_counts() -> None:
    field = Field(FENCE_ENABLE=1, FENCE_TYPE=4)
    upload(field, (FenceItem.CIRCLE_INCLUSION, Point(0, 0), (5,)), kind=MissionType.FENCE)
    field.wait(1.1)
    told = field.newest(m.FenceStatus)
    assert (told.breach_status, told.breach_count, told.breach_type, told.breach_time) == (0, 0, 0, 0)
    assert field.arm() is Result.ACCEPTED
    field.wait(0.2, NEUTRAL)
    while not field.newest(m.FenceStatus).breach_status:
        assert field.truth.north < 8.0
        field.wait(0.1, AHEAD)
    told = field.newest(m.FenceStatus)
    assert (told.breach_count, told.breach_type) == (1, 3)
    assert told.breach_time == pytest.approx(field.newest(m.Attitude).time_boot_ms, abs=400)
    at = told.breach_time
    field.set_mode(Mode.RTL)
    field.beat(15.0)
    told = field.newest(m.FenceStatus)
    assert (told.breach_status, told.breach_count, told.breach_type, told.breach_time) == (0, 1, 0, at)
