"""GUIDED: setpoints, timeouts and stops, with noisy sensors in a simulated field."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.enums import Command, Failsafe, Result
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, CYCLE, NEUTRAL, OTHER, Bench, said
from tests.vehicle.field import GROUND, TWIST, Field
from vehicle.navigation.geo import Point, wrap_angle

NAN = math.nan


def going() -> Field:
    field = Field()
    field.begin(Mode.GUIDED)
    field.stream(2.0, 0.8)
    assert field.speed == pytest.approx(0.8, abs=0.1)
    return field


class TestVelocity:
    def test_a_twist_drives_at_its_speed_and_turns_at_its_rate(self) -> None:
        field = going()
        before = field.yaw
        field.stream(2.0, 0.5, 0.5)
        assert field.speed == pytest.approx(0.5, abs=0.06)
        assert wrap_angle(field.yaw - before) == pytest.approx(1.0, abs=0.2)

    @pytest.mark.parametrize("frame", [1, 8])
    def test_a_velocity_with_all_other_fields_ignored_drives(self, frame: int) -> None:
        """MAVProxy's `velocity` and the usual scripts for drones send 0xFC7, with the bit of the force in it."""
        field = Field()
        field.begin(Mode.GUIDED)
        for _ in range(40):
            field.twist(0.8, frame=frame, mask=0xFC7)
            field.wait(0.05)
        assert field.speed == pytest.approx(0.8, abs=0.1)
        assert not said(field, "ignored")

    def test_backwards(self) -> None:
        field = going()
        field.stream(3.0, -0.5)
        assert field.speed == pytest.approx(-0.5, abs=0.1)

    def test_setpoint_loss_stops_after_1_s_and_holds_after_5_s(self) -> None:
        field = going()
        field.twist(0.8)
        field.wait(0.95)
        assert field.turning
        field.wait(0.6)
        assert not field.turning
        assert field.mode is Mode.GUIDED
        assert said(field, "setpoints lost: stopping")
        field.beat(3.0)
        assert field.mode is Mode.GUIDED
        field.beat(1.0)
        assert field.mode is Mode.HOLD
        assert field.newest(m.RoverFailsafeStatus).latched == Failsafe.GUIDED_LOSS
        field.stream(1.0, 0.8)
        assert not field.turning

    def test_a_new_setpoint_in_time_continues(self) -> None:
        field = going()
        field.wait(2.0)
        assert not field.turning
        field.stream(0.5, 0.8)
        assert field.turning

    @pytest.mark.parametrize("frame", [1, 7])
    def test_a_vector_to_the_east_drives_east(self, frame: int) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        mask = 1 | 2 | 4 | 64 | 128 | 256 | 1024 | 2048
        for _ in range(80):
            field.say(m.SetPositionTargetLocalNed(0, 1, 1, frame, mask, 0, 0, 0, 0, 0.6, 0, 0, 0, 0, 0, 0))
            field.wait(0.06)
        assert wrap_angle(field.yaw - math.pi / 2) == pytest.approx(0.0, abs=0.1)
        assert field.truth.east > 1.0

    def test_an_attitude_target_is_a_share_of_the_usual_speed(self) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        for _ in range(50):
            field.say(m.SetAttitudeTarget(0, 1, 1, 128 | 1 | 2, [1, 0, 0, 0], 0, 0, 0.3, 0.5))
            field.wait(0.06)
        assert field.speed == pytest.approx(0.4, abs=0.06)
        assert 0.3 < field.yaw < 1.2

    @pytest.mark.parametrize("mask", [128 | 32, 128 | 64 | 32])
    def test_thrust_body_is_used_if_selected(self, mask: int) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        for _ in range(50):
            field.say(m.SetAttitudeTarget(0, 1, 1, mask, [1, 0, 0, 0], 0, 0, 0.0, -1.0, [0.5, 0.9, 0.9]))
            field.wait(0.06)
        assert field.speed == pytest.approx(0.4, abs=0.06)

    def test_a_nan_in_thrust_body_is_rejected(self) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        field.say(m.SetAttitudeTarget(0, 1, 1, 128 | 32, [1, 0, 0, 0], 0, 0, 0.0, 0.5, [math.nan, 0, 0]))
        field.wait(0.5)
        assert said(field, "a value is not a number")
        assert not field.turning

    @pytest.mark.parametrize("length", [1.0, 0.9, 1.1, 3.0])
    def test_a_quaternion_of_any_length_is_a_heading(self, length: float) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        q = [length * math.cos(math.pi / 4), 0, 0, length * math.sin(math.pi / 4)]
        for _ in range(60):
            field.say(m.SetAttitudeTarget(0, 1, 1, 1 | 2 | 4, q, 0, 0, 0, 0.5))
            field.wait(0.06)
        assert wrap_angle(field.yaw - math.pi / 2) == pytest.approx(0.0, abs=0.1)

    def test_a_zero_quaternion_is_rejected(self) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        for _ in range(10):
            field.say(m.SetAttitudeTarget(0, 1, 1, 1 | 2 | 4, [0, 0, 0, 0], 0, 0, 0, 0.5))
            field.wait(0.06)
        assert not field.turning
        assert said(field, "invalid quaternion")

    def test_44_a_speed_above_the_maximum_is_limited(self) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        field.stream(2.0, 1e30)
        assert field.speed == pytest.approx(1.5, abs=0.2)
        field.stream(1.0, 0.0, -1e30)
        assert abs(field.rover._navigator._controller._turn_trim) <= 0.5
        assert all(abs(value) <= 1 for value in field.throttles)

    def test_a_rover_without_any_sensor_drives_by_feed_forward(self) -> None:
        bench = Bench()
        bench.arm()
        assert bench.set_mode(Mode.GUIDED) is Result.ACCEPTED
        for _ in range(20):
            bench.say(m.SetPositionTargetLocalNed(0, 1, 1, 8, TWIST, 0, 0, 0, 0.75, 0, 0, 0, 0, 0, 0, 0))
            bench.wait(0.05)
        assert bench.throttles == pytest.approx((0.5, 0.5))

    def test_47_an_overtaken_setpoint_is_ignored(self) -> None:
        field = going()
        field.twist(0.8, boot_ms=5000)
        field.twist(0.0, boot_ms=4990)
        field.wait(0.5)
        assert field.speed > 0.6
        field.wait(1.1)
        field.twist(0.8, boot_ms=10)  # its sender has started anew
        field.wait(0.2)
        assert field.turning


class TestPlace:
    @pytest.mark.parametrize("kind", [1, 2, 3, 4])
    def test_the_rover_drives_to_a_position_and_stops(self, kind: int) -> None:
        field = Field(DRIVE_TYPE=kind)
        field.begin(Mode.GUIDED)
        field.goto(8.0, 5.0)
        field.until(Point(8.0, 5.0), 60.0, 0.8)
        field.beat(6.0)
        assert field.speed == 0.0
        assert field.truth.distance(Point(8.0, 5.0)) < 0.8
        field.beat(10.0)
        assert field.mode is Mode.GUIDED  # a place does not get old

    def test_offset_frames_are_relative_to_the_rover_and_its_heading(self) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        field.goto(0.0, 4.0, frame=7)
        field.until(Point(0.0, 4.0), 30.0)
        field.beat(3.0)
        field.goto(3.0, 0.0, frame=9)  # the nose is to the east now
        field.until(Point(0.0, 7.0), 30.0)

    def test_reposition_changes_the_mode_if_its_flag_is_set(self) -> None:
        field = Field()
        field.arm()
        assert field.reposition(Point(5.0, 0.0), flags=0) is Result.DENIED
        assert field.reposition(Point(5.0, 0.0)) is Result.ACCEPTED
        field.until(Point(5.0, 0.0), 30.0)
        assert field.mode is Mode.GUIDED
        target = field.newest(m.PositionTargetGlobalInt)
        assert GROUND.to_local(target.lat_int / 1e7, target.lon_int / 1e7).distance(Point(5.0, 0.0)) < 0.05

    def test_reposition_can_set_the_speed(self) -> None:
        field = Field()
        field.arm()
        assert field.reposition(Point(20.0, 0.0), speed=0.4) is Result.ACCEPTED
        field.beat(4.0)
        assert field.speed == pytest.approx(0.4, abs=0.06)
        assert field.command(Command.DO_CHANGE_SPEED, 1, 1.2, -1) is Result.ACCEPTED
        field.goto(20.0, 1.0)
        field.beat(4.0)
        assert field.speed == pytest.approx(1.2, abs=0.1)

    def test_backwards(self) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        field.goto(-5.0, 0.0)
        assert field.command(Command.DO_SET_REVERSE, 1) is Result.ACCEPTED
        field.until(Point(-5.0, 0.0), 30.0)
        assert abs(wrap_angle(field.yaw)) < 0.3

    def test_a_lost_position_holds(self) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        field.goto(50.0, 0.0)
        field.beat(4.0)
        assert field.turning
        field.blind = {"gps_fix": None}
        field.beat(3.2)
        field.beat(0.6)
        assert not field.turning
        assert said(field, "position lost: stopping")
        field.beat(1.0)
        assert field.mode is Mode.HOLD
        field.blind = {}
        field.beat(3.0)
        assert not field.turning
        assert field.set_mode(Mode.LOITER) is Result.ACCEPTED


class TestStops:
    def test_manual_control_moves_nothing_in_guided_and_hold_stops(self) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        field.wait(1.0, NEUTRAL)
        field.wait(1.0, AHEAD)
        assert not field.turning
        field.stream(1.0, 0.8)
        assert field.turning
        assert field.set_mode(Mode.HOLD, OTHER) is Result.ACCEPTED
        field.wait(0.5)
        assert not field.turning

    def test_any_station_may_pause_and_only_the_owner_may_continue(self) -> None:
        field = Field()
        field.begin(Mode.GUIDED)
        field.goto(50.0, 0.0)
        field.beat(3.0)
        assert field.turning
        assert field.command(Command.DO_PAUSE_CONTINUE, 0, system=OTHER) is Result.ACCEPTED
        field.beat(2.0)
        assert not field.turning
        assert field.command(Command.DO_PAUSE_CONTINUE, 1, system=OTHER) is Result.FAILED
        assert field.command(Command.DO_PAUSE_CONTINUE, 1) is Result.ACCEPTED
        field.beat(1.0)
        assert field.turning

    def test_a_late_cycle_zeroes_the_outputs_at_once(self) -> None:
        field = going()
        field.freeze(0.15)
        field.cycle()
        assert not field.turning
        field.stream(0.5, 0.8)
        assert field.turning

    def test_a_process_stopped_for_long_ignores_the_old_setpoint(self) -> None:
        field = going()
        field.freeze(2.0)
        field.cycle()
        field.wait(CYCLE)
        assert not field.turning
