"""Each kind of drive, from demand to ground: mixer and chassis, which know nothing of each other, must agree."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import messages as m
from dialects.enums import DriveType
from tests.examples import examples
from tests.vehicle.bench import CYCLE
from tests.vehicle.field import Field
from vehicle.drive.demand import Demand
from vehicle.drive.drive import Drive
from vehicle.drive.gate import Clearance
from vehicle.params import Params
from vehicle.sim.chassis import CHASSIS, ChassisDimensions, ChassisMotion

SKID, ACKERMANN, OMNI, MECANUM = DriveType.SKID, DriveType.ACKERMANN, DriveType.OMNI, DriveType.MECANUM
CLEARED = Clearance(armed=True, late=False, held=False, neutral_seen=True, demand_age=0.1, timeout=0.45)
FRAME = ChassisDimensions(top_speed=1.0, track_width=0.6, wheelbase=0.4)


def driven(
    kind: DriveType, throttle: float, steering: float, sideways: float = 0.0, seconds: float = 3.0
) -> ChassisMotion:
    """How it moves after that long."""
    drive = Drive(Params({"DRIVE_TYPE": kind, "MAN_DEADBAND": 0}), 0.0)
    chassis = CHASSIS[kind](FRAME)
    for cycle in range(1, round(seconds / CYCLE) + 1):
        wish = Demand(throttle, steering, cycle * CYCLE, 255, 0, sideways)
        outputs = drive.update(wish, CLEARED, limited=False, now=cycle * CYCLE)
        chassis.step(outputs.throttles, 1.0, CYCLE)
    return chassis.motion


def sign(value: float) -> int:
    return 0 if abs(value) < 1e-6 else 1 if value > 0.0 else -1


@pytest.mark.parametrize("kind", CHASSIS)
@pytest.mark.parametrize("throttle", [0.6, -0.6])
def test_throttle_goes_straight(kind: DriveType, throttle: float) -> None:
    motion = driven(kind, throttle, 0.0)
    assert motion.speed == pytest.approx(throttle, abs=1e-3)
    assert (sign(motion.sideways), sign(motion.yaw_rate)) == (0, 0)
    assert sign(motion.north) == sign(throttle)
    assert sign(motion.east) == 0


@pytest.mark.parametrize("kind", CHASSIS)
@pytest.mark.parametrize("steering", [0.4, -0.4])
def test_steering_turns_the_nose_to_its_side(kind: DriveType, steering: float) -> None:
    motion = driven(kind, 0.4, steering, seconds=1.0)
    assert motion.speed > 0.3
    assert sign(motion.yaw_rate) == sign(steering) == sign(motion.east)


@pytest.mark.parametrize("kind", [SKID, OMNI, MECANUM])
def test_steering_alone_turns_on_the_spot(kind: DriveType) -> None:
    motion = driven(kind, 0.0, 0.5)
    assert motion.yaw_rate > 0.3
    assert math.hypot(motion.north, motion.east) < 1e-9


@pytest.mark.parametrize("kind", [OMNI, MECANUM])
@pytest.mark.parametrize("sideways", [1.0, -0.5])
def test_sideways_goes_aside_and_turns_nothing(kind: DriveType, sideways: float) -> None:
    motion = driven(kind, 0.0, 0.0, sideways)
    assert motion.sideways == pytest.approx(sideways, abs=1e-3)
    assert (sign(motion.speed), sign(motion.yaw), sign(motion.north)) == (0, 0, 0)
    assert sign(motion.east) == sign(sideways)


@pytest.mark.parametrize("kind", [SKID, ACKERMANN])
def test_sideways_is_nothing_to_the_others(kind: DriveType) -> None:
    motion = driven(kind, 0.0, 0.0, 1.0)
    assert (motion.north, motion.east, motion.yaw) == (0.0, 0.0, 0.0)


part = st.floats(-1 / 3, 1 / 3)


@pytest.mark.parametrize("kind", [OMNI, MECANUM])
@settings(max_examples=examples(25))
@given(part, part, part)
def test_four_wheels_make_each_wish_that_fits(
    kind: DriveType, throttle: float, steering: float, sideways: float
) -> None:
    motion = driven(kind, throttle, steering, sideways)
    made = (motion.speed, motion.sideways, motion.yaw_rate * (FRAME.track_width + FRAME.wheelbase) / 2)
    assert made == pytest.approx((throttle, sideways, steering), abs=2e-3)


@pytest.mark.parametrize("kind", [OMNI, MECANUM])
def test_a_wish_that_does_not_fit_keeps_its_direction(kind: DriveType) -> None:
    motion = driven(kind, 1.0, 0.0, 0.5)
    assert motion.speed == pytest.approx(2 / 3, abs=1e-3)
    assert motion.sideways == pytest.approx(1 / 3, abs=1e-3)


@pytest.mark.parametrize("kind", [OMNI, MECANUM])
@pytest.mark.parametrize(
    ("seed", "encoders"), [(None, 4), (1, 4), (1, 2), (1, 0)], ids=["perfect", "real", "two encoders", "no encoders"]
)
def test_a_rover_driven_aside_knows_its_place_and_heading(kind: DriveType, seed: int | None, encoders: int) -> None:
    field = Field(seed=seed, DRIVE_TYPE=kind)
    if encoders == 2:
        field.blind = {"wheel_speeds": (1.0, -1.0)}
    elif not encoders:
        field.blind = {"wheel_speeds": (), "speed": None}
    field.arm()
    for y in (*[0] * 5, *[1000] * 200, *[-300] * 50):
        field.say(m.ManualControl(1, 0, y, 0, 0, 0))
        field.wait(0.05)
    assert field.truth.east > 10.0
    assert abs(math.remainder(field.yaw, math.tau)) < 0.01
    assert abs(math.remainder((field.estimate.yaw or 0.0) - field.yaw, math.tau)) < 0.15
    assert field.estimate.place.distance(field.truth) < 1.5
    assert field.newest(m.LocalPositionNed).vy < -0.2
