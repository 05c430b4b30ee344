"""The state machine: stop commands of any station act before their answer is sent; motor faults; shutdown."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.enums import Command, DriveLimit, Failsafe, ModeFlag, Result, Severity, SystemState
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, DRIVER, NEUTRAL, OTHER, Bench, said
from tests.vehicle.conversations import conversation
from tests.vehicle.safety.rig import Rig
from vehicle.drive.gate import Outputs
from vehicle.readings import ComputerReadings
from vehicle.safety import states
from vehicle.safety.states import SafetyState

ARM, SWITCH, TERMINATE = Command.COMPONENT_ARM_DISARM, Command.DO_SET_SAFETY_SWITCH_STATE, Command.DO_FLIGHTTERMINATION
NAN = math.nan
ZERO = Outputs((0.0, 0.0), enabled=False)


@pytest.mark.parametrize("command", [(ARM, 0), (ARM, 0, 21196), (SWITCH, 0), (TERMINATE, 1)])
@pytest.mark.parametrize(("system", "introduced"), [(DRIVER, True), (OTHER, True), (OTHER, False)])
@pytest.mark.parametrize("target", [1, 0])
def test_stop_commands_zero_the_outputs_before_the_answer(
    command: tuple[int, ...], system: int, introduced: bool, target: int
) -> None:
    bench = Bench()
    bench.drive()
    assert bench.command(*command, system=system, introduced=introduced, target=target) is Result.ACCEPTED
    assert bench.rover.outputs == ZERO
    bench.wait(0.1, NEUTRAL)
    bench.wait(1.0, AHEAD)
    assert bench.rover.outputs == ZERO
    assert not bench.armed


@pytest.mark.parametrize("introduced", [True, False])
def test_hold_ramps_down(introduced: bool) -> None:
    bench = Bench()
    bench.drive()
    assert bench.command(Command.DO_SET_MODE, 1, Mode.HOLD, system=OTHER, introduced=introduced) is Result.ACCEPTED
    bench.wait(0.04, AHEAD)
    assert 0.5 < bench.throttles[0] < 1.0
    bench.wait(0.5, AHEAD)
    assert not bench.turning
    assert bench.armed
    assert bench.mode is Mode.HOLD


def test_an_emergency_stop_is_reported() -> None:
    bench = Bench()
    bench.drive()
    bench.command(SWITCH, 0)
    bench.wait(0.1)
    beat = bench.newest(m.Heartbeat)
    assert beat.system_status == SystemState.EMERGENCY
    assert not beat.base_mode & ModeFlag.ARMED
    assert bench.newest(m.RoverFailsafeStatus).latched == Failsafe.ESTOP
    assert bench.newest(m.RoverDriveStatus).limits & DriveLimit.ESTOP
    assert said(bench, f"EMERGENCY STOP by GCS {DRIVER}")


def test_release_then_arm_then_neutral() -> None:
    bench = Bench()
    bench.drive()
    bench.command(SWITCH, 0)
    assert bench.command(SWITCH, 1, system=OTHER) is Result.FAILED  # not in control
    assert bench.command(SWITCH, 1) is Result.ACCEPTED
    assert bench.rover.state is states.SafetyState.SAFE
    bench.wait(0.5, NEUTRAL)
    assert bench.arm() is Result.ACCEPTED
    bench.wait(0.5, AHEAD)
    assert not bench.turning
    bench.wait(0.1, NEUTRAL)
    bench.wait(0.1, AHEAD)
    assert bench.turning


@pytest.mark.parametrize("position", [2, 0.5, NAN, -1])
def test_an_invalid_position_of_the_switch_is_denied(position: float) -> None:
    bench = Bench()
    bench.drive()
    assert bench.command(SWITCH, position) is Result.DENIED
    assert bench.turning


def test_termination_lasts_until_a_restart() -> None:
    bench = Bench()
    bench.drive()
    bench.command(TERMINATE, 1)
    assert bench.command(SWITCH, 1) is Result.FAILED
    assert bench.command(ARM, 1, 21196) is Result.FAILED
    assert said(bench, "PreArm: terminated, restart the vehicle")
    bench.wait(0.1)
    assert bench.newest(m.Heartbeat).system_status == SystemState.FLIGHT_TERMINATION


@pytest.mark.parametrize("wish", [NAN, 0, 0.5, -1])
def test_59_termination_with_another_value_fails_with_a_text(wish: float) -> None:
    bench = Bench()
    bench.drive()
    assert bench.command(TERMINATE, wish) is Result.FAILED
    assert bench.turning
    assert said(bench, "termination refused")


class TestMotorDriver:
    def test_a_motor_fault_disarms_and_blocks_arming_until_repaired(self) -> None:
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

    def test_an_emergency_stop_does_not_clear_a_motor_fault(self) -> None:
        bench = Bench()
        bench.rover.motor_failed("broken", bench.now)
        bench.command(Command.DO_SET_SAFETY_SWITCH_STATE, 0)
        assert bench.command(Command.DO_SET_SAFETY_SWITCH_STATE, 1) is Result.ACCEPTED
        assert bench.rover.state is states.SafetyState.FAULT
        assert bench.arm() is Result.FAILED


class TestShutdown:
    def test_shutdown_sends_neutral_and_one_last_heartbeat(self) -> None:
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


def test_arming_reports_the_ground_station_and_the_mode() -> None:
    bench = Bench()
    bench.drive()
    assert said(bench, f"Armed by GCS {DRIVER}, mode MANUAL")


class TestWithoutADriver:
    def test_no_autonomous_mode_can_be_chosen_while_armed(self) -> None:
        bench = Bench()
        bench.arm()
        assert bench.set_mode(Mode.GUIDED) is Result.ACCEPTED
        assert bench.command(Command.REQUEST_OPERATOR_CONTROL, 0) is Result.ACCEPTED
        assert bench.set_mode(Mode.GUIDED, OTHER) is Result.FAILED
        assert said(bench, "Mode GUIDED refused: no GCS is in control")
        assert bench.set_mode(Mode.MANUAL, OTHER) is Result.ACCEPTED  # it drives nothing without a driver

    def test_disarmed_any_mode_can_be_chosen(self) -> None:
        assert Bench().set_mode(Mode.GUIDED) is Result.ACCEPTED


class TestStart:
    def test_nothing_is_confirmed_latched_or_wrong(self) -> None:
        safety = Rig().safety
        assert safety.state is SafetyState.BOOT
        assert not safety.armed
        assert not safety.terminated
        assert not safety.autonomy_confirmed
        assert safety.mode_generation == 0
        assert safety.latched == 0
        assert (safety.estop_reason, safety.motor_fault) == (None, None)

    @pytest.mark.parametrize(("number", "mode"), [(0, Mode.MANUAL), (4, Mode.HOLD)])
    def test_the_mode_is_a_parameter(self, number: float, mode: Mode) -> None:
        safety = Rig(INITIAL_MODE=number).safety
        assert safety.mode is safety.intended is mode


class TestArming:
    def test_who_arms_takes_control_and_the_drive_starts_again(self) -> None:
        rig = Rig()
        rig.cycle()
        rig.stick(AHEAD)
        generation = rig.safety.mode_generation
        rig.now += 5.0
        assert rig.safety.arm(conversation(DRIVER), rig.now) == []
        assert rig.control.ownership.owner == DRIVER
        assert rig.control.demand is None
        assert rig.safety.armed_at == rig.now
        assert rig.safety.mode_generation > generation
        assert not rig.safety.autonomy_confirmed
        assert rig.severity(f"Armed by GCS {DRIVER}, mode MANUAL") is Severity.NOTICE
        assert not rig.said("again to start")

    def test_an_earlier_demand_does_not_count(self) -> None:
        rig = Rig().armed()
        rig.safety.disarm("by GCS", rig.now)
        rig.stick(NEUTRAL)
        rig.stick(AHEAD)
        rig.now += 60.0
        rig.safety.arm(conversation(DRIVER), rig.now)
        assert rig.control.demand is None
        assert not rig.control.neutral_seen

    def test_again_by_the_owner_changes_nothing(self) -> None:
        rig = Rig().armed()
        before = (rig.safety.mode_generation, rig.safety.armed_at, len(rig.texts))
        rig.now += 5.0
        assert rig.safety.arm(conversation(DRIVER), rig.now) == []
        assert (rig.safety.mode_generation, rig.safety.armed_at, len(rig.texts)) == before

    def test_by_another_is_refused_whoever_may_take_over(self) -> None:
        rig = Rig().armed()
        rig.control.ownership.takeover_allowed = True
        rig.now += 60.0
        assert len(rig.safety.arm(conversation(OTHER), rig.now, force=True)) == 1
        assert rig.control.ownership.owner == DRIVER

    def test_by_another_while_disarmed_needs_control(self) -> None:
        rig = Rig().armed()
        rig.safety.disarm("by GCS", rig.now)
        assert len(rig.safety.arm(conversation(OTHER), rig.now)) == 1
        assert not rig.safety.armed

    def test_faults_are_reported_and_force_skips_the_soft_checks(self) -> None:
        rig = Rig()
        rig.cycle()
        rig.safety.battery.update(1.0, rig.now)
        rig.now += 4.0
        assert len(rig.safety.arm(conversation(DRIVER), rig.now)) == 1
        assert not rig.safety.armed
        assert rig.control.ownership.owner == 0
        assert rig.safety.arm(conversation(DRIVER), rig.now, force=True) == []

    def test_changed_safety_parameters_are_reported(self) -> None:
        rig = Rig(FS_TIMEOUT=5).armed()
        assert rig.severity("FS_TIMEOUT is 5") is Severity.WARNING
        assert not Rig().armed().said(", default")

    def test_what_was_latched_is_over(self) -> None:
        rig = Rig().armed()
        rig.endure(Failsafe.TILT)
        assert rig.safety.failsafes.latched == Failsafe.TILT
        rig.safety.arm(conversation(DRIVER), rig.now)
        assert not rig.safety.failsafes.latched

    @pytest.mark.parametrize(
        ("mode", "stands"), [(Mode.AUTO, True), (Mode.RTL, True), (Mode.GUIDED, False), (Mode.HOLD, False)]
    )
    def test_in_a_self_driving_mode_it_stands_until_chosen_again(self, mode: Mode, stands: bool) -> None:
        rig = Rig()
        rig.cycle()
        assert rig.safety.choose_mode(mode, rig.now) is None
        assert not rig.safety.autonomy_confirmed
        rig.safety.arm(conversation(DRIVER), rig.now)
        assert rig.said("again to start") is stands
        assert not rig.safety.autonomy_confirmed
        assert rig.safety.choose_mode(mode, rig.now) is None
        assert rig.safety.autonomy_confirmed


class TestProblems:
    """What prearm_problems finds: each fact by itself."""

    def only(self, rig: Rig) -> str:
        (problem,) = rig.safety.prearm_problems(rig.now)
        return problem

    def ready(self, **params: float) -> Rig:
        rig = Rig(**params)
        rig.cycle()
        assert rig.safety.prearm_problems(rig.now) == []
        return rig

    def test_mode_and_fence(self) -> None:
        rig = self.ready()
        rig.ready.unready[Mode.MANUAL] = "no gyro"
        assert "no gyro" in self.only(rig)
        rig.ready.unready.clear()
        rig.ready.unready[Mode.AUTO] = "no mission"
        assert rig.safety.prearm_problems(rig.now) == []
        rig.ready.fence_unenforceable_reason = "no fence"
        assert self.only(rig) == "no fence"

    def test_battery_low_critical_and_silent(self) -> None:
        rig = self.ready(BATT_LOW_TIMER=10)
        rig.safety.battery.update(9.0, rig.now)
        rig.now += 2.9
        assert rig.safety.prearm_problems(rig.now) == []
        rig.now += 0.2
        critical = self.only(rig)
        rig.now += 2.0
        silent = self.only(rig)
        rig.safety.battery.update(10.2, rig.now)
        rig.now += 5.0
        low = self.only(rig)
        assert len({critical, silent, low}) == 3

    def test_each_kind_of_emergency_stop_has_its_own_text(self) -> None:
        stopped, pressed, terminated = self.ready(), self.ready(), self.ready()
        stopped.safety.emergency_stop("GCS 255", stopped.now)
        pressed.safety.update_estop_input("pressed", pressed.now)
        terminated.safety.emergency_stop("GCS 255", terminated.now, terminate=True)
        assert self.only(pressed) == "pressed"
        assert len({self.only(stopped), self.only(pressed), self.only(terminated)}) == 3

    def test_a_stick_that_is_not_at_rest_while_it_is_fresh(self) -> None:
        rig = self.ready(MAN_TIMEOUT=0.5)
        rig.control.take(conversation(DRIVER), rig.now)
        rig.stick(NEUTRAL)
        assert rig.safety.prearm_problems(rig.now) == []
        rig.stick(AHEAD)
        assert self.only(rig)
        assert rig.safety.prearm_problems(rig.now, force=True) == []
        rig.now += 0.6
        assert rig.safety.prearm_problems(rig.now) == []

    def test_a_weak_supply(self) -> None:
        rig = self.ready()
        rig.safety.computer.update(ComputerReadings(under_voltage=True), rig.now)
        assert self.only(rig)


class TestDisarming:
    def test_it_is_reported_closes_the_interlock_and_ends_autonomy(self) -> None:
        rig = Rig().armed()
        rig.safety.choose_mode(Mode.GUIDED, rig.now)
        rig.stick(NEUTRAL)
        generation = rig.safety.mode_generation
        rig.safety.disarm("by GCS", rig.now)
        assert rig.safety.state is SafetyState.SAFE
        assert not rig.control.neutral_seen
        assert not rig.safety.autonomy_confirmed
        assert rig.safety.mode_generation > generation
        assert rig.severity("Disarmed: by GCS") is Severity.NOTICE

    def test_again_changes_nothing(self) -> None:
        rig = Rig()
        rig.cycle()
        rig.safety.disarm("by GCS", rig.now)
        assert rig.texts == []

    def test_a_silent_owner_loses_control_and_a_present_one_keeps_it(self) -> None:
        for silence, owner in ((4.9, DRIVER), (5.1, 0)):
            rig = Rig(FS_GCS_TIMEOUT=5).armed()
            rig.safety.disarm("by GCS", rig.now + silence)
            assert rig.control.ownership.owner == owner

    def test_end_of_a_motor_test_ends_requests_made_while_disarmed(self) -> None:
        rig = Rig()
        rig.cycle()
        generation = rig.safety.mode_generation
        rig.safety.end_motor_test()
        assert rig.safety.mode_generation == generation + 1
        assert not rig.safety.autonomy_confirmed
        rig = Rig().armed()
        rig.safety.choose_mode(Mode.GUIDED, rig.now)
        generation = rig.safety.mode_generation
        rig.safety.end_motor_test()
        assert (rig.safety.mode_generation, rig.safety.autonomy_confirmed) == (generation, True)
