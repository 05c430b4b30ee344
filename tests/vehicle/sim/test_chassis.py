from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle.sim.chassis import AckermannChassis, Chassis, ChassisDimensions, FourWheelChassis, SkidChassis

Kind = type[SkidChassis] | type[AckermannChassis] | type[FourWheelChassis]
KINDS = pytest.mark.parametrize("kind", [SkidChassis, AckermannChassis, FourWheelChassis])
DT = 0.02


def drive(chassis: Chassis, throttles: tuple[float, ...], seconds: float, strength: float = 1.0) -> None:
    for _ in range(round(seconds / DT)):
        chassis.step(throttles, strength, DT)


AHEAD: dict[Kind, tuple[float, ...]] = {
    SkidChassis: (1.0, 1.0),
    AckermannChassis: (1.0, 0.0),
    FourWheelChassis: (1.0,) * 4,
}
REST: dict[Kind, tuple[float, ...]] = {kind: (0.0,) * len(ahead) for kind, ahead in AHEAD.items()}


@KINDS
def test_reaches_its_top_speed_straight_north(kind: Kind) -> None:
    chassis = kind(ChassisDimensions(top_speed=2.0))
    drive(chassis, AHEAD[kind], 5.0)
    assert chassis.motion.speed == pytest.approx(2.0)
    assert chassis.motion.yaw == 0.0
    assert chassis.motion.north == pytest.approx(2.0 * (5.0 - 0.15), abs=0.05)  # the lag costs its time constant
    assert chassis.motion.east == 0.0


@KINDS
def test_lags_as_a_motor_does(kind: Kind) -> None:
    chassis = kind(ChassisDimensions(top_speed=1.0, motor_lag=0.2))
    drive(chassis, AHEAD[kind], 0.2)
    assert chassis.motion.speed == pytest.approx(1 - math.exp(-1))


@KINDS
def test_stands_still_at_last(kind: Kind) -> None:
    chassis = kind()
    drive(chassis, AHEAD[kind], 2.0)
    assert chassis.motion.speed > 1.0
    drive(chassis, REST[kind], 2.0)
    assert chassis.motion.speed == 0.0
    assert all(speed == 0.0 for speed in chassis.motion.wheel_speeds)
    north = chassis.motion.north
    drive(chassis, REST[kind], 1.0)
    assert chassis.motion.north == north


@KINDS
def test_a_weak_battery_drives_slower(kind: Kind) -> None:
    chassis = kind(ChassisDimensions(top_speed=1.0))
    drive(chassis, AHEAD[kind], 3.0, strength=0.8)
    assert chassis.motion.speed == pytest.approx(0.8)


@pytest.mark.parametrize(("throttles", "sign"), [((1.0, -1.0), 1), ((-1.0, 1.0), -1)])
def test_skid_turns_on_the_spot(throttles: tuple[float, float], sign: int) -> None:
    chassis = SkidChassis()
    drive(chassis, throttles, 1.0)
    assert math.copysign(1, chassis.motion.yaw_rate) == sign
    assert math.hypot(chassis.motion.north, chassis.motion.east) < 1e-9


def test_skid_turns_right_with_the_left_side_faster() -> None:
    chassis = SkidChassis(ChassisDimensions(top_speed=1.0, track_width=0.5, scrub=2.0))
    drive(chassis, (1.0, 0.5), 3.0)
    assert chassis.motion.yaw_rate == pytest.approx(0.5)
    assert chassis.motion.wheel_speeds == pytest.approx((1.0, 0.5))


def test_a_car_turns_on_its_circle() -> None:
    frame = ChassisDimensions(top_speed=1.0, wheelbase=0.3, steering_max=0.5)
    chassis = AckermannChassis(frame)
    drive(chassis, (1.0, 1.0), 3.0)
    assert chassis.motion.speed / chassis.motion.yaw_rate == pytest.approx(0.3 / math.tan(0.5))


def test_a_car_that_stands_does_not_turn() -> None:
    chassis = AckermannChassis()
    drive(chassis, (0.0, 1.0), 1.0)
    assert chassis.motion.yaw == 0.0


def test_a_car_that_backs_up_turns_the_other_way() -> None:
    chassis = AckermannChassis()
    drive(chassis, (-1.0, 1.0), 1.0)
    assert chassis.motion.speed < 0 > chassis.motion.yaw_rate


@pytest.mark.parametrize(
    ("throttles", "way"),
    [((1, -1, -1, 1), (0, 1)), ((-1, 1, 1, -1), (0, -1)), ((1, 0, 0, 1), (0.5, 0.5)), ((0, 1, 1, 0), (0.5, -0.5))],
)
def test_rollers_take_it_aside_without_a_turn(throttles: tuple[float, ...], way: tuple[float, float]) -> None:
    chassis = FourWheelChassis(ChassisDimensions(top_speed=1.0))
    drive(chassis, throttles, 3.0)
    assert (chassis.motion.speed, chassis.motion.sideways) == pytest.approx(way, abs=1e-6)
    assert chassis.motion.yaw == 0.0
    assert (chassis.motion.north, chassis.motion.east) == pytest.approx((way[0] * 2.85, way[1] * 2.85), abs=0.02)
    assert chassis.motion.velocity == pytest.approx(way, abs=1e-6)


def test_four_wheels_turn_on_the_spot_by_their_corner_distance() -> None:
    chassis = FourWheelChassis(ChassisDimensions(top_speed=1.0, track_width=0.6, wheelbase=0.4))
    drive(chassis, (1.0, -1.0, 1.0, -1.0), 2.0)
    assert chassis.motion.yaw_rate == pytest.approx(2.0, abs=1e-4)
    assert math.hypot(chassis.motion.north, chassis.motion.east) < 1e-9


def test_aside_is_aside_of_the_nose() -> None:
    chassis = FourWheelChassis()
    chassis.motion.yaw = math.pi / 2
    drive(chassis, (1.0, -1.0, -1.0, 1.0), 2.0)
    assert chassis.motion.north < -2.0
    assert abs(chassis.motion.east) < 1e-9


def test_wheels_that_fight_each_other_slip() -> None:
    chassis = FourWheelChassis()
    drive(chassis, (1.0, 1.0, -1.0, -1.0), 2.0)
    assert (chassis.motion.north, chassis.motion.east, chassis.motion.yaw) == (0.0, 0.0, 0.0)


throttle = st.floats(-1, 1)


@KINDS
@given(st.lists(st.tuples(throttle, throttle, throttle, throttle), min_size=1, max_size=50), st.floats(0.001, 0.02))
def test_never_runs_away(kind: Kind, course: list[tuple[float, ...]], dt: float) -> None:
    chassis = kind(ChassisDimensions(top_speed=1.5))
    for throttles in course:
        chassis.step(throttles[: len(AHEAD[kind])], 1.0, dt)
        assert abs(chassis.motion.speed) + abs(chassis.motion.sideways) <= 1.5 + 1e-9
        assert 0.0 <= chassis.motion.yaw <= math.tau  # a tiny turn left of north rounds to 2 pi
    assert math.hypot(chassis.motion.north, chassis.motion.east) <= 1.5 * dt * len(course) + 1e-9
