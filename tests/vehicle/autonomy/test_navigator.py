"""ACRO, mode choices, home, and stops of the autonomous modes in a simulated field with noisy sensors."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import Command, Result
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, EVERYTHING, NEUTRAL, OTHER, Bench, said
from tests.vehicle.field import GROUND, Field, away
from vehicle.navigation.geo import wrap_angle


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

    def test_acro_keeps_straight_without_steering(self) -> None:
        field = Field()
        field.begin(Mode.ACRO)
        field.wait(0.2, NEUTRAL)
        field.wait(6.0, Axes(0.5))
        assert abs(wrap_angle(field.yaw)) < 0.1
        assert field.truth.north > 3.0

    def test_acro_stops_when_the_demands_stop(self) -> None:
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


class TestHome:
    def test_home_can_be_moved(self) -> None:
        field = away()
        assert field.command(Command.DO_SET_HOME, 1) is Result.ACCEPTED
        field.wait(0.2)
        home = field.newest(m.HomePosition)
        assert GROUND.to_local(home.latitude / 1e7, home.longitude / 1e7).distance(field.truth) < 0.8
        assert field.command(Command.DO_SET_HOME, 0, 0, 0, 0, 50.0, 8.0, 100.0) is Result.ACCEPTED
        assert field.command(Command.DO_SET_HOME, 0, 0, 0, 0, 95.0, 8.0, 100.0) is Result.DENIED
        assert field.command_int(Command.DO_SET_HOME, 0, x=500000000, y=80000000, frame=1) is Result.UNSUPPORTED_FRAME

    @pytest.mark.parametrize("mode", [Mode.RTL, Mode.LOITER])
    def test_arming_in_autonomous_mode_moves_nothing_until_rechosen(self, mode: Mode) -> None:
        field = away()
        field.set_mode(mode)
        field.command(Command.COMPONENT_ARM_DISARM, 0)
        field.arm()
        assert field.mode is mode
        assert said(field, f"Choose {mode.name} again to start")
        assert field.stands_for(3.0)


class TestModes:
    @pytest.mark.parametrize(("pair", "mode"), [((4, 3), Mode.HOLD), ((4, 5), Mode.RTL), ((6, 0), Mode.GUIDED)])
    def test_px4_mode_pairs_are_accepted(self, pair: tuple[int, int], mode: Mode) -> None:
        field = away()
        assert field.command(Command.DO_SET_MODE, 1, *pair) is Result.ACCEPTED
        field.wait(0.1)
        assert field.mode is mode

    def test_standard_modes_are_accepted(self) -> None:
        field = away()
        assert field.command(Command.DO_SET_STANDARD_MODE, 5) is Result.ACCEPTED
        field.wait(0.1)
        assert field.newest(m.CurrentMode).standard_mode == 5
        assert field.mode is Mode.RTL
        assert field.command(Command.DO_SET_STANDARD_MODE, 2) is Result.FAILED

    def test_available_modes_and_their_sequence_follow_the_sensors(self) -> None:
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

    def test_a_lost_owner_holds_an_autonomous_mode(self) -> None:
        field = away()
        field.set_mode(Mode.RTL)
        field.wait(4.0)
        assert field.turning
        field.wait(3.0)
        assert field.mode is Mode.HOLD
        assert field.stands_for(1.0)


class TestStops:
    def test_hold_from_any_station_ends_an_autonomous_mode(self) -> None:
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
    def test_stop_commands_end_an_autonomous_mode_in_the_same_cycle(self, command: int, first: int) -> None:
        field = away()
        field.set_mode(Mode.RTL)
        field.beat(3.0)
        assert field.turning
        assert field.command(command, first, system=OTHER) is Result.ACCEPTED
        assert not field.turning
        assert field.stands_for(2.0)
