"""The outline of the rover: a gap shrinks as its closing speed says, for all motions and drives."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from dialects.enums import DriveType
from vehicle.params import Params
from vehicle.proximity.outline import Motion, Outline, OutlineGap, WheelMotion, carry
from vehicle.sim.chassis import CHASSIS, ChassisDimensions

OUTLINE = Outline(Params({"BODY_LENGTH": 0.6, "BODY_WIDTH": 0.4}))
SPEED = st.floats(-2.0, 2.0)


@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), SPEED, SPEED, SPEED)
def test_a_gap_shrinks_as_it_says(x: float, y: float, ahead: float, right: float, turn: float) -> None:
    gap, motion = OUTLINE.gap((x, y)), Motion(ahead, right, turn)
    assume(gap.clearance > 0.02)
    closing = gap.x * ahead + gap.y * right + gap.lever * turn
    after = OUTLINE.gap(carry([(x, y)], motion, 1e-4)[0])
    assert (gap.clearance - after.clearance) / 1e-4 == pytest.approx(closing, abs=0.02)


def test_a_gap_within_the_outline_leads_out() -> None:
    assert OUTLINE.gap((0.29, 0.0)) == OutlineGap(0.0, 1.0, 0.0, 0.0)
    assert OUTLINE.gap((0.0, -0.19))[:3] == (0.0, 0.0, -1.0)
    assert OUTLINE.gap((0.0, 0.0)).clearance == 0.0


def test_the_outline_by_direction() -> None:
    found = [OUTLINE.radius_at(math.radians(angle)) for angle in (0, 90, 180, 270)]
    assert found == pytest.approx([0.3, 0.2, 0.3, 0.2])
    assert OUTLINE.radius_at(math.atan2(0.2, 0.3)) == pytest.approx(OUTLINE.radius)


@pytest.mark.parametrize(
    ("kind", "wheels"),
    [(1, (0.8, 0.2)), (1, (-0.5, 0.5)), (2, (0.6, 0.5)), (2, (-0.6, -0.5)), (4, (0.8, 0.2, 0.5, -0.1))],
)
def test_wheels_move_the_rover_as_the_simulator_does(kind: int, wheels: tuple[float, ...]) -> None:
    chassis = CHASSIS[DriveType(kind)](ChassisDimensions())
    for _ in range(100):
        chassis.step(wheels, 1.0, 0.02)
    truth = chassis.motion
    motion = WheelMotion(Params({"DRIVE_TYPE": kind}), DriveType(kind)).of(wheels)
    assert motion[:2] == pytest.approx((truth.speed, truth.sideways), abs=0.02)
    assert motion.turn == pytest.approx(truth.yaw_rate, rel=0.1, abs=0.05)
