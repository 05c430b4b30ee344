"""Demands to MANUAL_CONTROL and back, for each kind of vehicle."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import permutations
from typing import NamedTuple

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dialects.axes import (
    AXIS_MAPS,
    CLIMB_SPAN,
    HOVER,
    LOWEST_THROTTLE,
    NEUTRAL,
    PX4_FRAMES,
    Axes,
    axis_map,
    build_manual_control,
    build_neutral,
    parse_axes,
    parse_manual_control,
)
from dialects.enums import Autopilot, VehicleType
from dialects.messages import INVALID_AXIS, ManualControl
from groundstation.actions import ACTIONS
from groundstation.input.keymap import KEYMAPS
from groundstation.input.sticks import Sticks
from groundstation.input.style import Style
from groundstation.intents.driving import DriveKeyDown
from tests.rows import each_row

ROVER = VehicleType.GROUND_ROVER
unit = st.floats(-1.0, 1.0)


@given(unit, unit, st.sampled_from(sorted(AXIS_MAPS)))
def test_a_demand_comes_back_as_it_was_sent(throttle: float, steering: float, autopilot: int) -> None:
    axes = axis_map(autopilot, ROVER)
    back = parse_manual_control(build_manual_control(Axes(throttle, steering), 1, axes), axes)
    assert back == pytest.approx((throttle, steering), abs=0.0011)


def test_our_rover_reads_x_and_r() -> None:
    message = build_manual_control(Axes(0.5, -1.0), 7)
    assert (message.target, message.x, message.r) == (7, 500, -1000)
    assert message.y == message.z == INVALID_AXIS


def test_ardupilot_reads_z_and_y_with_zero_as_neutral() -> None:
    message = build_manual_control(Axes(0.5, -1.0), 1, axis_map(Autopilot.ARDUPILOT, ROVER))
    assert (message.z, message.y) == (500, -1000)
    assert build_manual_control(NEUTRAL, 1, axis_map(Autopilot.ARDUPILOT, ROVER)).z == 0


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
    message = build_manual_control(Axes(throttle, nose), 1, axis_map(Autopilot.ARDUPILOT, ROVER))
    assert message.y == y


def test_px4_reads_z_with_500_as_neutral() -> None:
    px4 = axis_map(Autopilot.PX4, ROVER)
    assert build_manual_control(NEUTRAL, 1, px4).z == 500
    assert build_manual_control(Axes(-1.0, 0.0), 1, px4).z == 0
    assert build_manual_control(Axes(1.0, 0.0), 1, px4).z == 1000


def test_px4_gets_zero_on_unused_axes() -> None:
    """Old versions divide INT16_MAX by 1000; a mecanum rover would move sideways."""
    for frame in PX4_FRAMES:
        message = build_manual_control(Axes(0.5, 0.5), 1, axis_map(Autopilot.PX4, ROVER, frame))
        assert sorted((message.x, message.y, message.r)) == [0, 0, 500]


class Motion(NamedTuple):
    """What a rover does: forward, nose to the right, sideways to the right; each -1..1."""

    forward: float
    turn: float
    sideways: float = 0.0


def px4_sticks(message: ManualControl) -> tuple[float, float, float]:
    """Return throttle, roll and yaw as PX4's mavlink_receiver.cpp computes them."""
    roll, yaw = (axis / 1000 if -1000 <= axis <= 1000 else 0.0 for axis in (message.y, message.r))
    assert 0 <= message.z <= 1000
    return message.z / 500 - 1, roll, yaw


def ackermann(message: ManualControl) -> Motion:
    """rover_ackermann: roll steers the front wheels, so the nose follows them forward and leaves them in reverse."""
    throttle, roll, _ = px4_sticks(message)
    return Motion(throttle, throttle * roll)


def ackermann_acro(message: ManualControl) -> Motion:
    """rover_ackermann in ACRO, STABILIZED and POSCTL: roll, times the sign of the throttle, is the yaw rate."""
    throttle, roll, _ = px4_sticks(message)
    return Motion(throttle, sign(throttle) * roll)


def differential(message: ManualControl) -> Motion:
    """rover_differential: roll is the difference of the wheels, or the yaw rate."""
    throttle, roll, _ = px4_sticks(message)
    return Motion(throttle, roll)


def mecanum(message: ManualControl) -> Motion:
    """rover_mecanum: yaw turns, roll moves sideways."""
    throttle, roll, yaw = px4_sticks(message)
    return Motion(throttle, yaw, roll)


PX4_ROVERS = [(5, ackermann), (5, ackermann_acro), (6, differential), (13, mecanum)]
"""CA_AIRFRAME, and how such a rover moves."""

DRIVE_KEYS = {
    key: action.intent
    for key in ("u", "i", "o", "j", "l", "m", "comma", "full_stop")
    if (action := ACTIONS[KEYMAPS["standard"][key]]) and isinstance(action.intent, DriveKeyDown)
}


def px4_motion(keys: tuple[str, ...], frame: int, rover: Callable[[ManualControl], Motion]) -> Motion:
    """Return what a rover does while these keys are held, pressed in this order."""
    sticks = Sticks(Style.HOLD, 1.0)
    sticks.set_reports_releases()
    for key in keys:
        sticks.press(msgspec.structs.replace(DRIVE_KEYS[key], key=key), 0.0)
    return rover(build_manual_control(sticks.axes(0.0), 1, axis_map(Autopilot.PX4, ROVER, frame)))


def sign(value: float) -> int:
    return (value > 0) - (value < 0)


@pytest.mark.parametrize(("frame", "rover"), PX4_ROVERS)
def test_every_key_and_chord_moves_a_px4_rover_as_its_label_says(
    frame: int, rover: Callable[[ManualControl], Motion]
) -> None:
    """The nose turns to the side of the newest key that steers; a car that stands cannot turn."""
    assert len(DRIVE_KEYS) == 8
    for keys in [*permutations(DRIVE_KEYS, 1), *permutations(DRIVE_KEYS, 2)]:
        pushes = [DRIVE_KEYS[key] for key in keys]
        throttle = next((push.throttle for push in reversed(pushes) if push.throttle), 0)
        steering = next((push.steering for push in reversed(pushes) if push.steering), 0)
        expected = (throttle, 0 if frame == 5 and not throttle else steering, 0)
        assert tuple(map(sign, px4_motion(keys, frame, rover))) == expected, keys


@each_row(("frame", "rover"), PX4_ROVERS)
@each_row(("out", "back"), [("u", "m"), ("o", "full_stop"), ("i", "comma")])
def test_a_px4_rover_comes_back_on_the_same_arc(
    frame: int, rover: Callable[[ManualControl], Motion], out: str, back: str
) -> None:
    forward, backward = px4_motion((out,), frame, rover), px4_motion((back,), frame, rover)
    assert forward.forward == -backward.forward == 1.0
    assert forward.turn / forward.forward == backward.turn / backward.forward, "the curvature"


def test_an_unknown_autopilot_is_treated_as_specified() -> None:
    assert axis_map(99, ROVER) is axis_map(Autopilot.GENERIC, ROVER)


@pytest.mark.parametrize(("asked", "sent"), [(2.0, 1000), (-1e30, -1000), (math.nan, 0), (math.inf, 1000)])
def test_what_we_send_is_clamped(asked: float, sent: int) -> None:
    # ArduPilot does not clamp: z = 32766 is full ahead there.
    assert build_manual_control(Axes(asked, 0.0), 1).x == sent


@pytest.mark.parametrize("raw", [INVALID_AXIS, 1001, -1001, 5000, -32768])
def test_an_axis_that_is_invalid_or_out_of_range_is_no_demand(raw: int) -> None:
    throttle, steering = parse_manual_control(ManualControl(target=1, x=raw, y=0, z=0, r=250, buttons=0))
    assert throttle is None
    assert steering == 0.25


def test_the_neutral_of_what_flies_is_the_middle_of_z() -> None:
    flying = [kind for kind in range(46) if kind not in (10, 11)]
    for autopilot in (0, 3, 12, 5):
        assert [build_neutral(1, autopilot, kind).z for kind in flying] == [HOVER] * len(flying)
    assert build_neutral(1, Autopilot.ARDUPILOT, VehicleType.GROUND_ROVER).z == 0
    neutral = build_neutral(7, Autopilot.ARDUPILOT, 2)
    assert (neutral.target, neutral.x, neutral.y, neutral.r) == (7, 0, 0, 0)


anything = st.floats()


@given(anything, anything, anything, anything)
def test_no_demand_of_what_flies_is_below_the_least_z(a: float, b: float, c: float, d: float) -> None:
    message = build_manual_control(Axes(a, b, c, d), 1, axis_map(Autopilot.ARDUPILOT, 2))
    assert LOWEST_THROTTLE <= message.z <= HOVER + CLIMB_SPAN
    assert max(map(abs, (message.x, message.y, message.r))) <= 1000
    assert d < 0 or message.z >= HOVER


def test_each_axis_of_what_flies_has_its_own() -> None:
    message = build_manual_control(Axes(0.5, -0.2, 1.0, -0.6), 1, axis_map(Autopilot.PX4, 2))
    assert (message.x, message.r, message.y, message.z) == (500, -200, 1000, 300)
    message = build_manual_control(Axes(climb=-0.6), 1, axis_map(Autopilot.ARDUPILOT, 2))
    assert message.z == 280


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1))
def test_a_demand_of_what_flies_is_read_as_it_was_sent(a: float, b: float, c: float, d: float) -> None:
    for autopilot in (Autopilot.ARDUPILOT, Autopilot.PX4):
        axes = axis_map(autopilot, 2)
        read = parse_axes(build_manual_control(Axes(a, b, c, d), 1, axes), axes)
        assert read is not None
        for sent, seen in zip((a, b, c, d), (read.throttle, read.steering, read.side, read.climb), strict=True):
            assert seen == pytest.approx(sent, abs=0.005)


@pytest.mark.parametrize(("autopilot", "dead"), [(Autopilot.ARDUPILOT, 100), (Autopilot.PX4, 50)])
def test_the_least_climb_leaves_the_dead_zone_of_the_throttle(autopilot: int, dead: int) -> None:
    axes = axis_map(autopilot, 2)
    assert build_manual_control(Axes(climb=0.1), 1, axes).z > HOVER + dead
    assert build_manual_control(Axes(climb=-0.1), 1, axes).z < HOVER - dead


def test_an_axis_that_says_nothing_is_no_demand() -> None:
    assert parse_axes(ManualControl(1, 0, 32767, 32767, 0, 0), axis_map(Autopilot.ARDUPILOT, 2)) == NEUTRAL
