"""Failsafes: each first shows the wheels turning, then that and when they stop, and what it takes to go on."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from dialects import messages as m
from dialects.enums import Command, DriveLimit, Failsafe, Result, SystemState
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, CYCLE, DRIVER, NEUTRAL, Bench, said
from vehicle.drive.gate import Outputs
from vehicle.params import Params
from vehicle.readings import ComputerReadings, Readings
from vehicle.safety import states
from vehicle.safety.failsafe import RULES, FailsafeAction
from vehicle.safety.failsafe_state import Failsafes

ZERO = Outputs((0.0, 0.0), enabled=False)
SAFETY = Path(__file__).parents[3] / "docs" / "safety.md"


class TestBattery:
    def drained(self, bench: Bench, voltage: float) -> None:
        bench.readings = replace(bench.readings, battery_voltage=voltage)

    def test_low_holds_and_then_allows_half_speed(self) -> None:
        bench = Bench()
        self.drained(bench, 12.0)
        bench.drive()
        self.drained(bench, 10.4)
        bench.wait(9.0, AHEAD)
        assert bench.throttles == (1.0, 1.0)
        bench.wait(1.5, AHEAD)
        assert not bench.turning
        assert bench.mode is Mode.HOLD
        assert said(bench, "battery low: HOLD")
        bench.set_mode(Mode.MANUAL)
        bench.wait(0.1, NEUTRAL)
        bench.wait(1.0, AHEAD)
        assert bench.throttles == (0.5, 0.5)
        assert bench.newest(m.RoverDriveStatus).limits & DriveLimit.BATTERY

    def test_low_can_be_set_to_slow_down_only(self) -> None:
        bench = Bench(FS_LOW_ACT=0)
        bench.drive()
        self.drained(bench, 10.4)
        bench.wait(11.0, AHEAD)
        assert bench.throttles == (0.5, 0.5)

    def test_a_sag_of_a_moment_is_nothing(self) -> None:
        bench = Bench()
        bench.drive()
        for _ in range(5):
            self.drained(bench, 9.0)
            bench.wait(2.5, AHEAD)
            self.drained(bench, 11.0)
            bench.wait(0.5, AHEAD)
        assert bench.throttles == (1.0, 1.0)

    def test_critical_holds_blocks_modes_and_disarms(self) -> None:
        bench = Bench()
        bench.drive()
        self.drained(bench, 9.5)
        bench.wait(3.5, AHEAD)
        assert not bench.turning
        assert bench.mode is Mode.HOLD
        assert bench.set_mode(Mode.MANUAL) is Result.FAILED
        assert bench.set_mode(Mode.HOLD) is Result.ACCEPTED
        bench.wait(9.8, NEUTRAL)
        assert not bench.armed

    def test_who_arms_by_force_gets_the_whole_countdown(self) -> None:
        bench = Bench()
        self.drained(bench, 9.0)
        bench.wait(60.0)
        assert bench.command(Command.COMPONENT_ARM_DISARM, 1, 21196) is Result.ACCEPTED
        bench.wait(0.5, NEUTRAL)
        assert bench.mode is Mode.HOLD
        bench.wait(9.0, NEUTRAL)
        assert bench.armed
        bench.wait(1.0, NEUTRAL)
        assert not bench.armed

    def test_without_a_sensor_there_is_no_failsafe(self) -> None:
        bench = Bench()
        bench.readings = Readings(battery_voltage=math.nan)
        bench.drive()
        bench.wait(15.0, AHEAD)
        assert bench.throttles == (1.0, 1.0)


class TestComputer:
    def pi(self, bench: Bench, temperature: float = 50.0, *, weak: bool | None = False) -> None:
        bench.readings = Readings(computer=ComputerReadings(temperature=temperature, under_voltage=weak))
        bench.wait(0.04, AHEAD if bench.turning else None)

    @pytest.mark.parametrize(("temperature", "weak"), [(86.0, False), (50.0, True)])
    def test_half_speed_and_then_hold_and_then_half_speed_by_choice(self, temperature: float, weak: bool) -> None:
        bench = Bench()
        bench.drive()
        self.pi(bench, temperature, weak=weak)
        bench.wait(1.0, AHEAD)
        assert bench.throttles == (0.5, 0.5)
        assert said(bench, "Failsafe: Pi under-voltage or too hot: half speed")
        assert bench.newest(m.RoverFailsafeStatus).active == Failsafe.OVERHEAT
        assert bench.newest(m.RoverDriveStatus).limits & DriveLimit.SPEED
        assert not bench.newest(m.RoverDriveStatus).limits & DriveLimit.BATTERY
        bench.wait(8.5, AHEAD)
        assert bench.turning
        bench.wait(1.0, AHEAD)
        assert not bench.turning
        assert bench.mode is Mode.HOLD
        assert bench.newest(m.Heartbeat).system_status == SystemState.CRITICAL
        bench.set_mode(Mode.MANUAL)
        bench.wait(0.1, NEUTRAL)
        bench.wait(1.0, AHEAD)
        assert bench.throttles == (0.5, 0.5)
        self.pi(bench)
        bench.wait(6.0, AHEAD)
        assert bench.throttles == (1.0, 1.0)
        assert said(bench, "Failsafe cleared: Pi under-voltage or too hot")

    def test_a_supply_that_comes_and_goes_is_one_trouble_and_ends_in_hold(self) -> None:
        bench = Bench()
        bench.drive()
        for cycle in range(12):
            self.pi(bench, weak=cycle % 2 == 0)
            bench.wait(1.0, AHEAD)
        assert bench.mode is Mode.HOLD
        assert sum("half speed" in text for text in bench.texts) <= 1

    def test_a_dip_of_a_moment_slows_down_for_a_moment(self) -> None:
        bench = Bench()
        bench.drive()
        self.pi(bench, weak=True)
        self.pi(bench)
        bench.wait(4.5, AHEAD)
        assert bench.throttles == (0.5, 0.5)
        bench.wait(1.5, AHEAD)
        assert bench.throttles == (1.0, 1.0)
        bench.wait(20.0, AHEAD)
        assert bench.mode is Mode.MANUAL

    def test_what_nobody_knows_any_more_is_not_over(self) -> None:
        bench = Bench()
        bench.drive()
        self.pi(bench, weak=True)
        bench.readings = Readings()
        bench.wait(12.0, AHEAD)
        assert bench.mode is Mode.HOLD

    @pytest.mark.parametrize(("act", "throttle", "mode"), [(0, 1.0, Mode.MANUAL), (1, 0.5, Mode.MANUAL)])
    def test_what_follows_is_a_parameter(self, act: float, throttle: float, mode: Mode) -> None:
        bench = Bench(FS_PI_ACT=act)
        bench.drive()
        self.pi(bench, 100.0, weak=True)
        bench.wait(30.0, AHEAD)
        assert bench.throttles == (throttle, throttle)
        assert bench.mode is mode
        assert said(bench, "Pi under-voltage")
        assert (bench.newest(m.Heartbeat).system_status == SystemState.CRITICAL) == bool(act)

    @pytest.mark.parametrize(("limit", "throttle"), [(0, 1.0), (95, 1.0), (85, 0.5)])
    def test_so_is_the_temperature(self, limit: float, throttle: float) -> None:
        bench = Bench(FS_PI_TEMP=limit)
        bench.drive()
        self.pi(bench, 90.0)
        bench.wait(2.0, AHEAD)
        assert bench.throttles == (throttle, throttle)

    def test_nobody_arms_meanwhile_but_by_force_and_then_gets_the_whole_time(self) -> None:
        bench = Bench()
        self.pi(bench, 91.0, weak=True)
        bench.wait(60.0)
        assert bench.arm() is Result.FAILED
        bench.wait(0.1)
        assert said(bench, "PreArm: Pi under-voltage and Pi at 91 C")
        assert bench.command(Command.COMPONENT_ARM_DISARM, 1, 21196) is Result.ACCEPTED
        bench.wait(0.1, NEUTRAL)
        bench.wait(9.0, AHEAD)
        assert bench.throttles == (0.5, 0.5)
        bench.wait(1.5, AHEAD)
        assert bench.mode is Mode.HOLD

    def test_a_supply_that_is_well_again_allows_arming_at_once(self) -> None:
        bench = Bench(FS_PI_ACT=2)
        self.pi(bench, weak=True)
        assert bench.arm() is Result.FAILED
        self.pi(bench)
        assert bench.arm() is Result.ACCEPTED

    def test_who_does_not_want_it_arms(self) -> None:
        bench = Bench(FS_PI_ACT=0)
        self.pi(bench, weak=True)
        assert bench.arm() is Result.ACCEPTED


class TestLoop:
    def test_a_late_cycle_is_a_cycle_of_zero(self) -> None:
        bench = Bench()
        bench.drive()
        bench.freeze(0.15)
        bench.stick(AHEAD)
        assert bench.rover.outputs == ZERO
        bench.cycle()
        assert bench.rover.outputs == ZERO
        assert bench.armed
        bench.wait(0.1, AHEAD)
        assert bench.turning

    @pytest.mark.parametrize("first", ["tick", "demand"])
    def test_a_loop_that_stood_still_disarms(self, first: str) -> None:
        """Also when a demand that waited in the socket comes before the first cycle."""
        bench = Bench()
        bench.drive()
        bench.freeze(0.25)
        bench.cycle() if first == "tick" else bench.stick(AHEAD)
        assert bench.rover.outputs == ZERO
        assert not bench.armed
        bench.wait(0.1)
        assert said(bench, "Disarmed: control loop was 0.25 s late")

    def test_the_limit_is_a_parameter(self) -> None:
        bench = Bench(FS_LOOP_TIMEOUT=1.0)
        bench.drive()
        bench.freeze(0.9)
        bench.cycle()
        assert bench.armed
        assert not bench.turning


class TestMotorDriver:
    def test_zero_disarmed_and_no_arming_until_it_works_again(self) -> None:
        bench = Bench()
        bench.drive()
        bench.rover.motor_failed("no answer on /dev/ttyAMA0", bench.now)
        assert bench.rover.outputs == ZERO
        assert bench.rover.state is states.SafetyState.FAULT
        bench.wait(1.2)
        assert bench.newest(m.RoverFailsafeStatus).active == Failsafe.MOTOR_DRIVER
        assert said(bench, "Motor driver failed: no answer on")
        assert bench.command(Command.COMPONENT_ARM_DISARM, 1, 21196) is Result.FAILED
        bench.rover.motor_repaired(bench.now)
        assert bench.arm() is Result.ACCEPTED

    def test_an_emergency_stop_does_not_wash_it_away(self) -> None:
        bench = Bench()
        bench.rover.motor_failed("broken", bench.now)
        bench.command(Command.DO_SET_SAFETY_SWITCH_STATE, 0)
        assert bench.command(Command.DO_SET_SAFETY_SWITCH_STATE, 1) is Result.ACCEPTED
        assert bench.rover.state is states.SafetyState.FAULT
        assert bench.arm() is Result.FAILED


class TestIdle:
    def test_nobody_drives_for_long_and_the_rover_disarms(self) -> None:
        bench = Bench(DISARM_DELAY=20)
        bench.drive()
        bench.wait(15.0, NEUTRAL, period=0.2)
        assert bench.armed
        bench.wait(6.0, NEUTRAL, period=0.2)
        assert not bench.armed
        assert said(bench, "Disarmed: no demand for 20 s")


class TestShutdown:
    def test_neutral_first_and_one_last_word(self) -> None:
        bench = Bench()
        bench.drive()
        bench.rover.shutdown(bench.now)
        assert bench.rover.outputs == ZERO
        last = bench.rover.messages_to_send()
        assert [each.message.system_status for each in last] == [SystemState.POWEROFF]  # type: ignore[attr-defined]
        bench.wait(1.0, AHEAD)
        bench.rover.shutdown(bench.now)
        assert bench.rover.messages_to_send() == []
        assert bench.rover.outputs == ZERO


class TestTable:
    """RULES and Failsafes without a rover."""

    def test_worst_wins(self) -> None:
        failsafes = Failsafes(Params())
        failsafes.update({Failsafe.BATTERY_LOW: 0.0}, 0.0)
        assert failsafes.lasting_action(0.0) is FailsafeAction.LIMIT
        failsafes.update({Failsafe.BATTERY_LOW: 0.0, Failsafe.MANUAL_LOSS: 0.0}, 0.0)
        assert failsafes.lasting_action(0.0) is FailsafeAction.NEUTRAL

    def test_each_step_is_taken_once(self) -> None:
        failsafes = Failsafes(Params())
        taken = [
            step.action
            for cycle in range(2000)
            for step in failsafes.update({Failsafe.MANUAL_LOSS: 0.0}, cycle * CYCLE)
        ]
        assert taken == [FailsafeAction.NEUTRAL, FailsafeAction.HOLD, FailsafeAction.DISARM]

    def test_a_condition_that_returns_begins_anew(self) -> None:
        failsafes = Failsafes(Params())
        failsafes.update({Failsafe.GCS_LOSS: 0.0}, 0.0)
        failsafes.update({}, 1.0)
        assert failsafes.active == 0
        assert failsafes.latched == Failsafe.GCS_LOSS
        assert [step.action for step in failsafes.update({Failsafe.GCS_LOSS: 2.0}, 2.0)] == [FailsafeAction.HOLD]

    def test_the_table_of_the_documentation_has_every_rule(self) -> None:
        documented = SAFETY.read_text(encoding="utf-8")
        for rule in RULES.values():
            assert f"| {rule.label} | {rule.help} |" in documented

    def test_no_rule_starts_a_motion_and_every_rule_has_words(self) -> None:
        for rule in RULES.values():
            assert rule.label
            assert rule.steps
            assert all(step.action in FailsafeAction for step in rule.steps)

    def test_the_driver_in_control_is_not_named_in_vain(self) -> None:
        bench = Bench()
        bench.drive()
        assert said(bench, f"Armed by GCS {DRIVER}, mode MANUAL")
