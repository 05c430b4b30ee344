"""Demands that are accepted and ignored: bad inputs 31 to 42, and the neutral-first interlock."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Command, DriveLimit
from tests.vehicle.bench import AHEAD, CYCLE, DRIVER, NEUTRAL, OTHER, Bench, said


def axes(**raw: int) -> m.ManualControl:
    """MANUAL_CONTROL with raw axis values."""
    return m.ManualControl(target=1, **({"x": 0, "y": 0, "z": 0, "r": 0, "buttons": 0} | raw))


def test_a_demand_acts_before_the_next_cycle() -> None:
    bench = Bench()
    bench.arm()
    bench.wait(0.1, NEUTRAL)
    bench.now += 0.005  # between two cycles
    bench.stick(AHEAD)
    assert bench.turning


@pytest.mark.parametrize("target", [0, 2, 255])
def test_31_a_demand_for_another_system_is_ignored(target: int) -> None:
    bench = Bench()
    bench.drive()
    bench.wait(1.2)
    assert not bench.turning
    bench.stick(NEUTRAL, target=target)
    for _ in range(5):
        bench.stick(AHEAD, target=target)
        bench.wait(CYCLE)
        assert not bench.turning


def test_32_demands_of_another_station_are_ignored_and_reported() -> None:
    bench = Bench()
    bench.drive()
    bench.texts.clear()
    for _ in range(5):
        bench.wait(0.1, AHEAD)
        bench.stick(Axes(throttle=-1.0), system=OTHER)
    assert bench.throttles == (1.0, 1.0)
    assert bench.texts == [f"Demand from GCS {OTHER} ignored: GCS {DRIVER} is in control"]


def test_a_peer_without_a_heartbeat_is_ignored() -> None:
    bench = Bench()
    bench.arm()
    bench.say(build_manual_control(NEUTRAL, 1), introduced=False)
    bench.say(build_manual_control(AHEAD, 1), introduced=False)
    bench.wait(CYCLE)
    assert not bench.turning


def test_33_a_disabled_axis_is_neutral() -> None:
    bench = Bench()
    bench.drive()
    for _ in range(20):
        bench.say(axes(x=m.INVALID_AXIS, r=500))
        bench.wait(0.04)
    assert bench.throttles == pytest.approx((0.4845, -0.4845), abs=1e-3)


@pytest.mark.parametrize("wild", [5000, -32768, 1001, -1001])
def test_34_an_axis_out_of_range_is_neutral_and_not_clamped(wild: int) -> None:
    bench = Bench()
    bench.drive()
    for _ in range(20):
        bench.say(axes(x=wild, r=0))
        bench.wait(0.04)
    assert not bench.turning
    assert bench.texts.count(f"GCS {DRIVER}: axes outside -1000..1000 count as neutral") == 1


def test_valid_and_disabled_axes_are_not_reported() -> None:
    bench = Bench()
    bench.drive()
    for x in (1000, -1000, m.INVALID_AXIS):
        bench.say(axes(x=x, r=m.INVALID_AXIS))
        bench.wait(0.04)
    assert not said(bench, "axes outside")


def test_y_moves_an_omni_drive_sideways() -> None:
    bench = Bench(DRIVE_TYPE=4)
    bench.drive()
    for _ in range(20):
        bench.say(axes(y=1000))
        bench.wait(0.04)
    assert bench.throttles == (1.0, -1.0, -1.0, 1.0)


@pytest.mark.parametrize("kind", [1, 2])
def test_y_is_ignored_by_drives_that_cannot_move_sideways(kind: int) -> None:
    """QGroundControl sends it for every vehicle."""
    bench = Bench(DRIVE_TYPE=kind)
    bench.arm()
    bench.say(axes(y=1000))
    bench.say(axes(x=500, y=-1000))
    bench.wait(CYCLE)
    assert bench.turning
    for _ in range(20):
        bench.say(axes(y=1000))
        bench.wait(0.04)
    assert not bench.turning


def test_a_stick_held_sideways_is_not_neutral() -> None:
    bench = Bench(DRIVE_TYPE=4)
    bench.arm()
    for side in (1000, 500, 1000):
        bench.say(axes(y=side))
        bench.wait(CYCLE)
        assert not bench.turning
    bench.say(axes())
    bench.say(axes(y=500))
    bench.wait(CYCLE)
    assert bench.turning


def test_y_out_of_range_is_no_demand() -> None:
    bench = Bench(DRIVE_TYPE=4)
    bench.drive()
    for _ in range(20):
        bench.say(axes(y=1001))
        bench.wait(0.04)
    assert not bench.turning


def test_a_frame_without_any_valid_axis_is_no_demand() -> None:
    bench = Bench()
    bench.drive()
    for _ in range(30):
        bench.say(axes(x=m.INVALID_AXIS, r=m.INVALID_AXIS))
        bench.wait(0.04)
    assert not bench.turning  # stale
    assert said(bench, "manual control lost")


def test_an_invalid_axis_proves_no_stick_at_rest() -> None:
    bench = Bench()
    bench.arm()
    bench.say(axes(x=m.INVALID_AXIS, r=0))
    bench.wait(0.2, AHEAD)
    assert not bench.turning


def test_35_full_throttle_from_the_first_frame_waits_for_neutral() -> None:
    bench = Bench()
    bench.arm()
    bench.wait(1.0, AHEAD)
    assert not bench.turning
    assert bench.newest(m.RoverDriveStatus).limits & DriveLimit.NEUTRAL_FIRST
    bench.wait(0.1, NEUTRAL)
    bench.wait(0.1, AHEAD)
    assert bench.turning


def test_36_a_replayed_frame_does_not_keep_the_rover_moving() -> None:
    bench = Bench()
    bench.drive()
    bench.say(build_manual_control(AHEAD, 1), sequence=77)
    for _ in range(50):
        bench.wait(0.04)
        bench.say(build_manual_control(AHEAD, 1), sequence=77)
    assert not bench.turning


def test_37_of_two_ground_stations_only_the_owner_drives() -> None:
    bench = Bench()
    bench.drive()
    for _ in range(20):
        bench.wait(0.04)
        bench.stick(AHEAD)
        bench.stick(Axes(throttle=-1), system=OTHER)
        assert min(bench.throttles) > 0.5


def test_38_one_frame_per_second_never_keeps_the_rover_moving() -> None:
    bench = Bench()
    bench.drive()
    moving = 0
    for _ in range(5):
        bench.wait(0.94)
        assert not bench.turning
        bench.stick(AHEAD)
        moving += bench.turning
    assert moving == 0  # what went stale while driving begins with neutral


def test_39_accessory_axes_and_buttons_do_nothing() -> None:
    bench = Bench()
    bench.arm()
    bench.wait(0.1, NEUTRAL)
    bench.say(axes(y=1000, z=1000, buttons=0xFFFF, buttons2=0xFFFF, s=1000, t=1000, aux1=1000))
    bench.wait(0.1)
    assert not bench.turning
    assert bench.armed


def test_40_a_demand_while_disarmed_or_stopped_has_no_effect() -> None:
    bench = Bench()
    bench.heartbeat()
    bench.wait(0.2, NEUTRAL)
    bench.wait(0.5, AHEAD)
    assert not bench.turning
    bench.drive()
    bench.command(Command.DO_SET_SAFETY_SWITCH_STATE, 0)
    assert not bench.turning
    bench.wait(0.1, NEUTRAL)
    bench.wait(0.5, AHEAD)
    assert not bench.turning


def test_41_full_ahead_to_full_reverse_goes_through_zero_in_time() -> None:
    bench = Bench(MOT_REV_DELAY=0.2)
    bench.drive()
    seen = []
    for _ in range(60):
        bench.wait(CYCLE, Axes(throttle=-1.0))
        seen.append(bench.throttles[0])
    assert seen[0] >= 0.9
    assert seen.count(0.0) >= 9  # 0.2 s at zero
    assert seen[-1] == -1.0
    assert max(abs(new - old) for new, old in zip(seen[1:], seen, strict=False)) <= 0.0501
    assert any(message.limits & DriveLimit.REVERSE_DELAY for message in bench.all(m.RoverDriveStatus))


def test_a_small_demand_is_neutral() -> None:
    bench = Bench()
    bench.arm()
    bench.say(axes(x=20, r=-20))  # within MAN_DEADBAND: a stick at rest
    bench.wait(0.2, AHEAD)
    assert bench.turning
