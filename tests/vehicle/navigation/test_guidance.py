"""ATC_TURN_MAX_G: path following limits the lateral acceleration."""

from __future__ import annotations

import math

import pytest

from dialects.enums import DriveType
from dialects.modes import Mode
from tests.rows import each_row
from tests.vehicle.field import Field
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point
from vehicle.navigation.guidance import GRAVITY, PathFollower
from vehicle.params import Params


def guide(kind: DriveType = DriveType.SKID, **params: float) -> PathFollower:
    return PathFollower(Params({"ATC_STR_RAT_MAX": 720, **params}), kind)


HERE = Point(0.0, 0.0)


def at(speed: float, yaw: float = 0.0, place: Point = HERE) -> Estimate:
    return Estimate(yaw=yaw, speed=speed, place=place)


@each_row("grip", [0.1, 0.3, 0.6])
@each_row("speed", [-3.0, -1.0, 0.5, 1.0, 3.0, 10.0])
def test_steering_at_speed_respects_the_lateral_limit(grip: float, speed: float) -> None:
    limit = grip * GRAVITY / abs(speed)
    path = guide(ATC_TURN_MAX_G=grip, ATC_STR_ANG_P=10, WP_PIVOT_ANGLE=180, SPEED_MAX=30)
    assert path.limit_turn_rate(100.0, speed, at(0.0)) == pytest.approx(min(limit, math.radians(720)))
    assert path.limit_turn_rate(-100.0, 0.0, at(speed)) == pytest.approx(-min(limit, math.radians(720)))
    for motion in (path.steer_heading(2.0, at(speed), speed), path.steer_course(2.0, at(speed), abs(speed))):
        assert abs(motion.turn_rate) * abs(speed) <= grip * GRAVITY + 1e-9
        assert motion.turn_rate


def test_at_rest_only_the_turn_rate_is_limited() -> None:
    assert guide(ATC_TURN_MAX_G=0.1).limit_turn_rate(99.0, 0.0, at(0.0)) == pytest.approx(math.radians(720))


def test_a_circle_is_driven_at_the_largest_allowed_speed() -> None:
    path = guide(ATC_TURN_MAX_G=0.1, SPEED_MAX=30)
    on_it = at(5.0, yaw=math.pi / 2, place=Point(4.0, 0.0))
    motion = path.orbit(Point(0.0, 0.0), 4.0, on_it, 5.0)
    assert motion.speed == pytest.approx(math.sqrt(0.1 * GRAVITY * 4.0), rel=0.01)


def cornering(field: Field, seconds: float, turn_rate: float) -> float:
    """Largest sideways acceleration in m/s/s, as the plant knows it."""
    largest, end = 0.0, field.now + seconds
    while field.now < end:
        field.twist(1.4, turn_rate)
        before = field.yaw
        field.wait(0.1)
        turned = abs(math.remainder(field.yaw - before, math.tau)) / 0.1
        largest = max(largest, turned * abs(field.speed))
    return largest


def test_guided_respects_the_lateral_limit() -> None:
    wild, tame = Field(seed=None, ATC_TURN_MAX_G=10), Field(seed=None, ATC_TURN_MAX_G=0.1)
    found = []
    for field in (wild, tame):
        field.begin(Mode.GUIDED)
        cornering(field, 2.0, 0.0)
        found.append(cornering(field, 3.0, 2.0))
    assert found[0] > 0.17 * GRAVITY
    assert found[1] < 0.13 * GRAVITY
