"""Demands to MANUAL_CONTROL and back, for each kind of vehicle."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dialects.axes import AXIS_MAPS, NEUTRAL, Axes, axis_map, build_manual_control, parse_manual_control
from dialects.enums import Autopilot
from dialects.messages import INVALID_AXIS, ManualControl

unit = st.floats(-1.0, 1.0)


@given(unit, unit, st.sampled_from(sorted(AXIS_MAPS)))
def test_a_demand_comes_back_as_it_was_sent(throttle: float, steering: float, autopilot: int) -> None:
    axes = axis_map(autopilot)
    back = parse_manual_control(build_manual_control(Axes(throttle, steering), 1, axes), axes)
    assert back == pytest.approx((throttle, steering), abs=0.0011)


def test_our_rover_reads_x_and_r() -> None:
    message = build_manual_control(Axes(0.5, -1.0), 7)
    assert (message.target, message.x, message.r) == (7, 500, -1000)
    assert message.y == message.z == INVALID_AXIS


def test_ardupilot_reads_z_and_y_with_zero_as_neutral() -> None:
    message = build_manual_control(Axes(0.5, -1.0), 1, axis_map(Autopilot.ARDUPILOT))
    assert (message.z, message.y) == (500, -1000)
    assert build_manual_control(NEUTRAL, 1, axis_map(Autopilot.ARDUPILOT)).z == 0


FORWARD, BACKWARD, LEFT, RIGHT = 1, -1, -1, 1


@pytest.mark.parametrize(
    ("throttle", "nose", "y"),
    [
        (FORWARD, LEFT, -1000),
        (FORWARD, RIGHT, 1000),
        (BACKWARD, LEFT, 1000),  # the wheels to the right: a car that backs up turns its nose left
        (BACKWARD, RIGHT, -1000),
        (0, LEFT, -1000),  # on the spot
        (0, RIGHT, 1000),
        (BACKWARD, 0, 0),
    ],
)
def test_ardupilot_turns_the_other_way_in_reverse(throttle: int, nose: int, y: int) -> None:
    message = build_manual_control(Axes(throttle, nose), 1, axis_map(Autopilot.ARDUPILOT))
    assert message.y == y


def test_px4_reads_z_with_500_as_neutral() -> None:
    px4 = axis_map(Autopilot.PX4)
    assert build_manual_control(NEUTRAL, 1, px4).z == 500
    assert build_manual_control(Axes(-1.0, 0.0), 1, px4).z == 0
    assert build_manual_control(Axes(1.0, 0.0), 1, px4).z == 1000


def test_an_unknown_autopilot_is_treated_as_the_specification_says() -> None:
    assert axis_map(99) is axis_map(Autopilot.GENERIC)


@pytest.mark.parametrize(("asked", "sent"), [(2.0, 1000), (-1e30, -1000), (math.nan, 0), (math.inf, 1000)])
def test_what_we_send_is_clamped(asked: float, sent: int) -> None:
    # ArduPilot does not clamp: z = 32766 is full ahead there.
    assert build_manual_control(Axes(asked, 0.0), 1).x == sent


@pytest.mark.parametrize("raw", [INVALID_AXIS, 1001, -1001, 5000, -32768])
def test_an_axis_that_is_invalid_or_out_of_range_is_no_demand(raw: int) -> None:
    throttle, steering = parse_manual_control(ManualControl(target=1, x=raw, y=0, z=0, r=250, buttons=0))
    assert throttle is None
    assert steering == 0.25
