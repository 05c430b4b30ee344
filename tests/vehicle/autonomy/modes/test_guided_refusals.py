"""Setpoints and commands of the autonomous modes that are rejected, and the reason that is reported."""

from __future__ import annotations

import math
from typing import Any

import pytest

from dialects import messages as m
from dialects.enums import Command, Result
from dialects.modes import Mode
from tests.vehicle.autonomy.modes.test_guided import going
from tests.vehicle.bench import DRIVER, OTHER, Bench, said
from tests.vehicle.field import ONLY_PLACE, TWIST, Field
from vehicle.navigation.geo import Point

NAN = math.nan


class TestRefusals:
    @pytest.mark.parametrize(
        ("frame", "mask", "why"),
        [
            (2, TWIST, "frame 2"),
            (8, TWIST & ~64, "acceleration"),
            (8, TWIST & ~64 | 512, "force"),
            (8, 0xFFF & ~512, "all fields are ignored"),
            (8, 0xFFF, "all fields are ignored"),
            (1, ONLY_PLACE | 1, "incomplete position"),
        ],
    )
    def test_45_an_unsupported_setpoint_is_reported_once(self, frame: int, mask: int, why: str) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        field.texts.clear()
        for _ in range(30):
            field.goto(5.0, 0.0, frame=frame, mask=mask)
            field.wait(0.2)
        assert not field.turning
        assert sum(why in text for text in field.texts) == 1

    @pytest.mark.parametrize("index", [5, 6, 8, 9, 14, 15])
    def test_43_a_used_value_that_is_no_number_is_rejected(self, index: int) -> None:
        field = going()
        values: list[Any] = [0, 1, 1, 8, 64 | 128 | 256 | 4, 1.0, 1.0, 0, 0.1, 0.1, 0, 0, 0, 0, 0.1, 0.1]
        values[index] = NAN
        field.say(m.SetPositionTargetLocalNed(*values))
        assert said(field, "is not a number")
        field.wait(0.3)
        assert field.speed > 0.7

    def test_an_ignored_field_may_have_any_value(self) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        field.say(m.SetPositionTargetLocalNed(0, 1, 1, 8, TWIST, NAN, NAN, NAN, 0.5, 0, NAN, NAN, NAN, NAN, NAN, 0))
        field.wait(0.5)
        assert field.turning

    def test_46_is_ignored_without_mode_arming_or_control(self) -> None:
        field = Field()
        field.twist(0.8)
        assert said(field, "no GCS is in control")
        field.arm()
        field.twist(0.8)
        field.wait(0.5)
        assert said(field, "mode is MANUAL, not GUIDED")
        field.set_mode(Mode.GUIDED)
        field.twist(0.8, system=OTHER)
        field.wait(0.5)
        assert said(field, f"GCS {DRIVER} is in control")
        assert field.stands_for(1.0)

    def test_a_setpoint_from_before_arming_moves_nothing_after_it(self) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        field.goto(20.0, 0.0)
        field.beat(2.0)
        assert field.turning
        field.command(Command.COMPONENT_ARM_DISARM, 0)
        field.arm()
        assert field.mode is Mode.GUIDED
        assert field.stands_for(3.0)

    @pytest.mark.parametrize(
        ("x", "y"), [(0, 0), (2**31 - 1, 80_000_000), (500_000_000, 2**31 - 1), (910_000_000, 0), (0, 1_810_000_000)]
    )
    def test_53_reposition_to_invalid_position_is_denied(self, x: int, y: int) -> None:
        field = Field()
        field.arm()
        assert field.command_int(Command.DO_REPOSITION, -1, 1, x=x, y=y) is Result.DENIED

    def test_reposition_needs_command_int_a_global_frame_and_control(self) -> None:
        field = Field()
        place = Point(5.0, 0.0)
        assert field.reposition(place) is Result.FAILED  # not armed
        field.arm()
        assert field.command(Command.DO_REPOSITION, -1, 1, 0, NAN, 50.0, 8.0) is Result.INT_ONLY
        assert field.reposition(place, frame=1) is Result.UNSUPPORTED_FRAME
        assert field.reposition(place, flags=2) is Result.DENIED
        assert field.reposition(place, speed=math.inf) is Result.DENIED
        assert field.command_int(Command.DO_REPOSITION, -1, 1, x=1, y=1, system=OTHER) is Result.FAILED
        assert field.stands_for(1.0)

    def test_modes_that_need_a_position_or_gyro_are_rejected_without(self) -> None:
        bench = Bench()
        bench.arm()
        for mode in (Mode.LOITER, Mode.RTL, Mode.SMART_RTL, Mode.ACRO):
            assert bench.set_mode(mode) is Result.FAILED
            bench.wait(0.5)
        assert said(bench, "position is not known")
        assert said(bench, "there is no gyro")
        assert bench.command(Command.DO_SET_HOME, 1) is Result.FAILED
        assert bench.command(Command.NAV_RETURN_TO_LAUNCH) is Result.FAILED
        bench.set_mode(Mode.GUIDED)
        bench.say(m.SetPositionTargetLocalNed(0, 1, 1, 1, ONLY_PLACE, 5, 5, 0, 0, 0, 0, 0, 0, 0, 0, 0))
        assert said(bench, "position is not known")

    @pytest.mark.parametrize("params", [(2, 1.0), (NAN, 1.0), (1, NAN), (1, -0.5), (1, math.inf)])
    def test_an_invalid_speed_is_denied(self, params: tuple[float, ...]) -> None:
        assert Field().command(Command.DO_CHANGE_SPEED, *params) is Result.DENIED

    def test_too_high_a_speed_is_limited_and_reported(self) -> None:
        field = Field()
        assert field.command(Command.DO_CHANGE_SPEED, 1, 99) is Result.ACCEPTED
        assert said(field, "limited to 1.5")
        assert field.command(Command.DO_CHANGE_SPEED, 1, -2) is Result.ACCEPTED
        assert field.rover._navigator.cruise_speed() == pytest.approx(0.8)

    @pytest.mark.parametrize("command", [Command.DO_SET_REVERSE, Command.DO_PAUSE_CONTINUE, Command.DO_SET_HOME])
    def test_a_value_other_than_0_and_1_is_denied(self, command: int) -> None:
        for value in (0.5, NAN, 2):
            assert Field().command(command, value) is Result.DENIED
