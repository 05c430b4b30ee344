"""ACRO, RTL, SMART_RTL, LOITER and the failsafes of sensors: in a simulated field with noisy sensors."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import Command, Failsafe, ModeFlag, Result, SystemState
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, EVERYTHING, NEUTRAL, OTHER, Bench, said
from tests.vehicle.field import GROUND, Field
from vehicle.autonomy.trail import TRAIL_MAX, Trail
from vehicle.navigation.geo import Point, wrap_angle

START = Point(0.0, 0.0)


def away() -> Field:
    """Armed, and driven by hand around a corner."""
    field = Field()
    field.arm()
    field.wait(0.2, NEUTRAL)
    field.wait(10.0, Axes(0.5))
    field.wait(1.0, Axes(0.0, 0.4))
    field.wait(8.0, Axes(0.5))
    field.wait(0.5, NEUTRAL)
    assert field.truth.distance(START) > 6.0
    return field


class TestAcro:
    def test_steering_is_a_turn_rate_that_the_gyro_holds(self) -> None:
        field = Field(ACRO_TURN_RATE=90)
        field.begin(Mode.ACRO)
        field.wait(0.2, NEUTRAL)
        field.wait(2.0, Axes(0.4, 0.5))
        before = field.yaw
        field.wait(2.0, Axes(0.4, 0.5))
        rate = 90 * (0.5 - 0.03) / 0.97
        assert math.degrees(wrap_angle(field.yaw - before)) / 2 == pytest.approx(rate, abs=4)

    def test_without_steering_it_keeps_straight_where_manual_would_not(self) -> None:
        field = Field()
        field.begin(Mode.ACRO)
        field.wait(0.2, NEUTRAL)
        field.wait(6.0, Axes(0.5))
        assert abs(wrap_angle(field.yaw)) < 0.1
        assert field.truth.north > 3.0

    def test_it_is_driven_by_the_driver_so_his_silence_stops_it(self) -> None:
        field = Field()
        field.begin(Mode.ACRO)
        field.wait(0.5, AHEAD)
        assert not field.turning  # neutral first
        field.wait(0.2, NEUTRAL)
        field.wait(1.0, AHEAD)
        assert field.turning
        field.wait(1.0)
        assert not field.turning
        field.beat(2.0)
        assert field.mode is Mode.HOLD

    def test_at_rest_the_noise_of_the_gyro_moves_nothing(self) -> None:
        field = Field()
        field.begin(Mode.ACRO)
        for _ in range(100):
            field.wait(0.05, NEUTRAL)
            assert not field.turning


class TestHoming:
    def test_rtl_goes_home_and_ends_in_hold(self) -> None:
        field = away()
        assert field.command(Command.NAV_RETURN_TO_LAUNCH) is Result.ACCEPTED
        assert field.newest(m.Heartbeat).base_mode & ModeFlag.AUTO
        field.until(START, 60.0, 0.6)
        field.beat(4.0)
        assert field.mode is Mode.HOLD
        assert said(field, "home is reached: HOLD")
        assert field.truth.distance(START) < 0.8
        assert field.stands_for(2.0)

    def test_smart_rtl_goes_back_the_way_it_came(self) -> None:
        field = away()
        corner = max(field.track, key=lambda place: place.north - place.east)
        field.track.clear()
        assert field.set_mode(Mode.SMART_RTL) is Result.ACCEPTED
        field.until(START, 90.0, 0.9)
        field.beat(6.0)
        assert field.mode is Mode.HOLD
        assert min(place.distance(corner) for place in field.track) < 1.0

    def test_home_can_be_moved(self) -> None:
        field = away()
        assert field.command(Command.DO_SET_HOME, 1) is Result.ACCEPTED
        field.wait(0.2)
        home = field.newest(m.HomePosition)
        assert GROUND.to_local(home.latitude / 1e7, home.longitude / 1e7).distance(field.truth) < 0.8
        assert field.command(Command.DO_SET_HOME, 0, 0, 0, 0, 50.0, 8.0, 100.0) is Result.ACCEPTED
        assert field.command(Command.DO_SET_HOME, 0, 0, 0, 0, 95.0, 8.0, 100.0) is Result.DENIED
        assert field.command_int(Command.DO_SET_HOME, 0, x=500000000, y=80000000, frame=1) is Result.UNSUPPORTED_FRAME

    def test_loiter_stays_and_comes_back_when_moved(self) -> None:
        field = away()
        assert field.set_mode(Mode.LOITER) is Result.ACCEPTED
        here = field.truth
        assert field.stands_for(2.0)
        assert field.body is not None
        field.body.motion.north += 2.5
        field.beat(60.0)  # the filter hides a jump for some time, as it hides a GPS that jumps
        assert field.truth.distance(here) < 1.5

    @pytest.mark.parametrize("mode", [Mode.RTL, Mode.LOITER])
    def test_arming_in_it_moves_nothing_until_it_is_chosen_again(self, mode: Mode) -> None:
        field = away()
        field.set_mode(mode)
        field.command(Command.COMPONENT_ARM_DISARM, 0)
        field.arm()
        assert field.mode is mode
        assert said(field, f"Choose {mode.name} again to start")
        assert field.stands_for(3.0)

    def test_a_loop_is_no_part_of_the_trail_and_a_long_one_gets_coarser(self) -> None:
        trail = Trail()
        for north, east in ((0, 0), (5, 0), (5, 5), (0.2, 5), (0.3, 0.3), (-4, 0)):
            trail.add(Point(north, east))
        assert trail.points == [Point(0, 0), Point(-4, 0)]
        for step in range(3 * TRAIL_MAX):
            trail.add(Point(-4.0 - 2.0 * step, 0.0))
        assert len(trail.points) <= TRAIL_MAX + 1
        assert trail.points[0] == Point(0, 0)


class TestModes:
    @pytest.mark.parametrize(("pair", "mode"), [((4, 3), Mode.HOLD), ((4, 5), Mode.RTL), ((6, 0), Mode.GUIDED)])
    def test_the_pairs_of_px4(self, pair: tuple[int, int], mode: Mode) -> None:
        field = away()
        assert field.command(Command.DO_SET_MODE, 1, *pair) is Result.ACCEPTED
        field.wait(0.1)
        assert field.mode is mode

    def test_the_standard_modes(self) -> None:
        field = away()
        assert field.command(Command.DO_SET_STANDARD_MODE, 5) is Result.ACCEPTED
        field.wait(0.1)
        assert field.newest(m.CurrentMode).standard_mode == 5
        assert field.mode is Mode.RTL
        assert field.command(Command.DO_SET_STANDARD_MODE, 2) is Result.FAILED

    def test_the_menu_changes_with_the_sensors_and_says_so(self) -> None:
        bench = Bench()
        bench.wait(4.0)
        before = bench.newest(m.AvailableModesMonitor).seq
        bench.command(Command.REQUEST_MESSAGE, m.AvailableModes.id, 0)
        hidden = {Mode(each.custom_mode) for each in bench.all(m.AvailableModes) if each.properties & 2}
        assert {Mode.ACRO, Mode.RTL, Mode.INITIALISING} <= hidden
        assert not {Mode.MANUAL, Mode.HOLD, Mode.GUIDED} & hidden
        bench.readings = EVERYTHING
        bench.wait(4.0)
        assert bench.newest(m.AvailableModesMonitor).seq != before
        bench.sent.clear()
        bench.command(Command.REQUEST_MESSAGE, m.AvailableModes.id, 0)
        assert [each.custom_mode for each in bench.all(m.AvailableModes) if each.properties & 2] == [Mode.INITIALISING]

    def test_the_owner_gone_holds_whatever_drives(self) -> None:
        field = away()
        field.set_mode(Mode.RTL)
        field.wait(4.0)
        assert field.turning
        field.wait(3.0)
        assert field.mode is Mode.HOLD
        assert field.stands_for(1.0)


class TestHazards:
    def test_tilted_disarms(self) -> None:
        bench = Bench()
        bench.readings = EVERYTHING
        bench.drive()
        bench.readings = replace(EVERYTHING, roll=-0.9)
        bench.wait(0.4, AHEAD)
        assert bench.turning
        bench.wait(0.2, AHEAD)
        assert not bench.armed
        assert said(bench, "Disarmed: tilted")

    @pytest.mark.parametrize(("check", "armed"), [(1, True), (2, False)])
    def test_blocked_holds(self, check: int, armed: bool) -> None:
        bench = Bench(FS_CRASH_CHECK=check)
        bench.readings = EVERYTHING
        bench.drive()
        bench.readings = replace(EVERYTHING, wheel_speeds=(0.01, 0.0))
        bench.wait(1.9, AHEAD)
        assert bench.turning
        bench.wait(0.8, AHEAD)
        assert not bench.turning
        assert bench.armed is armed
        assert not armed or bench.mode is Mode.HOLD
        assert bench.newest(m.RoverFailsafeStatus).latched & Failsafe.BLOCKED

    @pytest.mark.parametrize("change", [{"wheel_speeds": (0.0, 0.0)}, {"roll": -0.9}])
    def test_a_moment_of_it_is_nothing_to_tell(self, change: dict[str, Any]) -> None:
        """Each start, each change of direction stands for a moment, and a stone tilts."""
        bench = Bench()
        bench.readings = EVERYTHING
        bench.drive()
        bench.texts.clear()
        for _ in range(3):
            bench.readings = replace(EVERYTHING, **change)
            bench.wait(0.4, AHEAD)
            status = bench.newest(m.RoverFailsafeStatus)
            assert (status.active, status.action_in_ms) == (0, 65535)
            bench.readings = EVERYTHING
            bench.wait(1.2, AHEAD)
        assert bench.turning
        assert not said(bench, "Failsafe")
        assert {beat.system_status for beat in bench.all(m.Heartbeat)[-4:]} == {SystemState.ACTIVE}

    def test_both_can_be_turned_off(self) -> None:
        bench = Bench(FS_CRASH_CHECK=0, CRASH_ANGLE=0)
        bench.readings = replace(EVERYTHING, roll=2.0, wheel_speeds=(0.0, 0.0))
        bench.drive()
        bench.wait(5.0, AHEAD)
        assert bench.turning

    def test_a_hold_of_anybody_ends_what_drives_by_itself(self) -> None:
        field = away()
        field.set_mode(Mode.RTL)
        field.beat(3.0)
        assert field.turning
        assert field.set_mode(Mode.HOLD, OTHER) is Result.ACCEPTED
        field.beat(0.5)
        assert field.stands_for(2.0)

    @pytest.mark.parametrize(
        ("command", "first"),
        [(Command.DO_SET_SAFETY_SWITCH_STATE, 0), (Command.COMPONENT_ARM_DISARM, 0), (Command.DO_FLIGHTTERMINATION, 1)],
    )
    def test_the_stop_set_ends_it_in_the_same_cycle(self, command: int, first: int) -> None:
        field = away()
        field.set_mode(Mode.RTL)
        field.beat(3.0)
        assert field.turning
        assert field.command(command, first, system=OTHER) is Result.ACCEPTED
        assert not field.turning
        assert field.stands_for(2.0)
