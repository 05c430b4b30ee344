"""Commands: bad inputs 48 to 52, 55, 57 to 59 of the design, arming with reasons, modes, and the stop set."""

from __future__ import annotations

import math

import pytest
from msgspec.structs import replace

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import Command, ModeFlag, Result, SystemState
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, DRIVER, NEUTRAL, OTHER, Bench, logged, said
from vehicle.drive.gate import Outputs
from vehicle.readings import Readings

ARM, SWITCH, TERMINATE = Command.COMPONENT_ARM_DISARM, Command.DO_SET_SAFETY_SWITCH_STATE, Command.DO_FLIGHTTERMINATION
NAN = math.nan
ZERO = Outputs((0.0, 0.0), enabled=False)


class TestArming:
    def test_armed_is_told_at_once(self) -> None:
        bench = Bench()
        assert not bench.newest(m.Heartbeat).base_mode & ModeFlag.ARMED
        bench.wait(0.1)
        assert bench.arm() is Result.ACCEPTED
        beat = bench.newest(m.Heartbeat)
        assert beat.base_mode == ModeFlag.CUSTOM | ModeFlag.MANUAL | ModeFlag.ARMED
        assert beat.system_status == SystemState.ACTIVE
        assert said(bench, f"Armed by GCS {DRIVER}, mode MANUAL")

    @pytest.mark.parametrize("wish", [0.5, NAN, 2, -1, math.inf])
    def test_48_neither_yes_nor_no_is_denied(self, wish: float) -> None:
        bench = Bench()
        bench.drive()
        assert bench.command(ARM, wish) is Result.DENIED
        assert bench.turning
        assert bench.armed

    def test_49_force_does_not_beat_the_emergency_stop(self) -> None:
        bench = Bench()
        bench.command(SWITCH, 0)
        for force in (0, 21196, 2989):
            assert bench.command(ARM, 1, force) is Result.FAILED
        assert said(bench, "PreArm: emergency stop, release it first")

    @pytest.mark.parametrize("force", [21196, 2989])
    def test_force_skips_soft_checks(self, force: float) -> None:
        bench = Bench()
        bench.readings = Readings(battery_voltage=9.0)
        bench.wait(15.0)
        assert bench.arm() is Result.FAILED
        assert said(bench, "PreArm: battery critical")
        assert bench.command(ARM, 1, 1) is Result.FAILED
        assert bench.command(ARM, 1, force) is Result.ACCEPTED

    def test_force_does_not_skip_settings_that_do_not_fit(self) -> None:
        bench = Bench(BATT_LOW_VOLT=10, BATT_CRT_VOLT=11)
        assert bench.command(ARM, 1, 21196) is Result.FAILED
        assert said(bench, "PreArm: BATT_CRT_VOLT is above BATT_LOW_VOLT")

    def test_a_silent_battery_sensor_blocks(self) -> None:
        bench = Bench()
        bench.readings = Readings(battery_voltage=12.0)
        bench.wait(1.0)
        bench.readings = Readings()
        bench.wait(5.5)
        assert bench.arm() is Result.FAILED
        assert said(bench, "PreArm: no data from the battery sensor")

    def test_a_stick_that_is_held_blocks(self) -> None:
        bench = Bench()
        bench.arm()
        bench.command(ARM, 0)
        bench.wait(0.2, AHEAD)
        assert bench.arm() is Result.FAILED
        assert said(bench, "PreArm: throttle or steering not neutral")

    def test_armed_already_is_accepted_and_changes_nothing(self) -> None:
        bench = Bench()
        bench.drive()
        assert bench.arm() is Result.ACCEPTED
        assert bench.turning

    def test_arming_does_not_take_an_armed_rover_from_its_driver(self) -> None:
        bench = Bench()
        bench.drive()
        assert bench.arm(OTHER) is Result.FAILED
        bench.wait(0.2, AHEAD)
        assert bench.turning

    def test_who_has_shown_no_heartbeat_cannot_arm(self) -> None:
        bench = Bench()
        assert bench.command(ARM, 1, introduced=False) is Result.FAILED
        assert not bench.armed
        assert logged(bench, "COMPONENT_ARM_DISARM refused: no HEARTBEAT received")

    def test_51_broadcast_arming_is_ignored_and_disarming_obeyed(self) -> None:
        bench = Bench()
        assert bench.command(ARM, 1, target=0) is None
        assert not bench.armed
        bench.drive()
        assert bench.command(ARM, 0, target=0) is Result.ACCEPTED
        assert bench.rover.outputs == ZERO

    def test_50_for_another_component_there_is_no_answer(self) -> None:
        bench = Bench()
        assert bench.command(ARM, 1, component=42) is None
        assert bench.command(ARM, 1, target=2) is None
        assert not bench.armed
        assert bench.command(ARM, 1, component=0) is Result.ACCEPTED

    def test_52_ten_times_is_once_and_ten_answers(self) -> None:
        bench = Bench()
        for _ in range(10):
            assert bench.arm() is Result.ACCEPTED
        bench.wait(0.5)
        assert sum("Armed by" in text for text in bench.texts) == 1

    def test_a_refusal_repeated_by_the_client_is_said_once(self) -> None:
        bench = Bench(BATT_LOW_VOLT=10, BATT_CRT_VOLT=11)
        for _ in range(6):
            bench.arm()
            bench.wait(0.35)
        assert sum("PreArm" in text for text in bench.texts) == 1

    def test_prearm_checks_on_request(self) -> None:
        bench = Bench()
        assert bench.command(Command.RUN_PREARM_CHECKS) is Result.ACCEPTED
        assert said(bench, "PreArm: ready to arm")
        bench.command(SWITCH, 0)
        assert bench.command(Command.RUN_PREARM_CHECKS) is Result.ACCEPTED
        assert said(bench, "PreArm: emergency stop")
        bench.command(SWITCH, 1)
        bench.arm()
        assert bench.command(Command.RUN_PREARM_CHECKS) is Result.TEMPORARILY_REJECTED


class TestModes:
    def test_hold_and_manual(self) -> None:
        bench = Bench()
        for mode in (Mode.HOLD, Mode.MANUAL):
            assert bench.set_mode(mode) is Result.ACCEPTED
            bench.wait(0.1)
            assert bench.newest(m.CurrentMode).custom_mode == mode
            assert bench.newest(m.Heartbeat).custom_mode == mode

    @pytest.mark.parametrize(
        "params",
        [
            (1, Mode.STEERING),
            (1, Mode.INITIALISING),
            (1, 99),
            (1, NAN),
            (NAN, 0),
            (1, 0.5),
            (0, 0),
            (1, 0, math.inf),
            (1, 4, 9),
            (1, 1e30),
        ],
    )
    def test_what_is_not_offered_is_denied(self, params: tuple[float, ...]) -> None:
        bench = Bench()
        bench.drive()
        assert bench.command(Command.DO_SET_MODE, *params) is Result.DENIED
        assert bench.turning
        assert said(bench, "is not offered")

    def test_mavsdks_hold_is_known(self) -> None:
        bench = Bench()
        bench.drive()
        assert bench.command(Command.DO_SET_MODE, 129, 4, 3) is Result.ACCEPTED
        bench.wait(0.6, AHEAD)
        assert not bench.turning

    def test_others_cannot_start_motion(self) -> None:
        bench = Bench()
        bench.drive()
        bench.set_mode(Mode.HOLD)
        assert bench.set_mode(Mode.MANUAL, system=OTHER) is Result.FAILED
        assert said(bench, f"DO_SET_MODE refused: GCS {DRIVER} is in control")

    def test_a_mode_for_all_vehicles_is_only_hold(self) -> None:
        bench = Bench()
        bench.drive()
        assert bench.command(Command.DO_SET_MODE, 1, Mode.HOLD, target=0) is Result.ACCEPTED
        bench.wait(0.6, AHEAD)
        assert not bench.turning
        assert bench.command(Command.DO_SET_MODE, 1, Mode.MANUAL, target=0) is None

    def test_standard_modes_fail_as_the_specification_says(self) -> None:
        bench = Bench()
        assert bench.command(Command.DO_SET_STANDARD_MODE, 5) is Result.FAILED
        assert bench.command(Command.DO_SET_STANDARD_MODE, NAN) is Result.DENIED

    def test_the_old_set_mode_is_honoured_without_answer(self) -> None:
        bench = Bench()
        bench.drive()
        acks = len(bench.all(m.CommandAck))
        bench.say(m.SetMode(1, 1, Mode.HOLD))
        bench.wait(0.6, AHEAD)
        assert not bench.turning
        bench.say(m.SetMode(1, 1, 77))
        assert said(bench, "Refused: mode 77 is not offered")
        bench.say(m.SetMode(1, 128, Mode.ACRO))  # MAVProxy's `arm safetyon` says this too: ACRO is offered, this is not
        assert said(bench, "Refused: base mode 128 without a custom mode is not offered")
        bench.say(m.SetMode(2, 1, Mode.MANUAL))
        bench.wait(0.1)
        assert bench.mode is Mode.HOLD
        assert len(bench.all(m.CommandAck)) == acks

    def test_it_starts_in_the_mode_that_is_set(self) -> None:
        bench = Bench(INITIAL_MODE=Mode.HOLD)
        bench.arm()
        bench.wait(0.1, NEUTRAL)
        bench.wait(0.5, AHEAD)
        assert not bench.turning


@pytest.mark.parametrize("command", [65535, 0, 521])
def test_58_an_unknown_command_is_unsupported(command: int) -> None:
    bench = Bench()
    bench.drive()
    assert bench.command(command, 1) is Result.UNSUPPORTED
    assert bench.turning
    assert bench.command(command, 1, target=0) is None


def test_command_int_works_alike() -> None:
    bench = Bench()
    bench.say(m.CommandInt(1, 1, 0, ARM, 0, 0, 1, 0, 0, 0, 0, 0, 0))
    assert bench.newest(m.CommandAck).result == Result.ACCEPTED
    assert bench.armed


def test_ackermann_drives_throttle_and_steering() -> None:
    bench = Bench(DRIVE_TYPE=2)
    bench.drive(Axes(throttle=0.5, steering=-1.0))
    assert bench.throttles == pytest.approx((0.4845, -1.0), abs=1e-3)
    servos = bench.newest(m.ServoOutputRaw)
    assert servos.servo1_raw == 1100
    assert servos.servo3_raw == pytest.approx(1694, abs=1)


def test_two_of_our_own_failures_at_once_are_both_told() -> None:
    bench = Bench()
    bench.readings = replace(bench.readings, battery_voltage=9.0)
    bench.wait(15.0)
    bench.rover.motor_failed("broken", bench.now)
    bench.arm()
    bench.wait(0.5)
    assert said(bench, "PreArm: motor driver: broken")
    assert said(bench, "PreArm: battery critical")


def test_a_cancel_with_nothing_under_way_is_ignored() -> None:
    bench = Bench()
    before = len(bench.all(m.CommandAck))
    bench.say(m.CommandCancel(1, 1, Command.DO_REPOSITION))
    bench.wait(0.1)
    assert len(bench.all(m.CommandAck)) == before
