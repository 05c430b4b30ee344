"""The state machine: stop commands of any station act before their answer is sent; motor faults; shutdown."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.enums import Command, DriveLimit, Failsafe, ModeFlag, Result, SystemState
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, DRIVER, NEUTRAL, OTHER, Bench, said
from vehicle.drive.gate import Outputs
from vehicle.safety import states

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
