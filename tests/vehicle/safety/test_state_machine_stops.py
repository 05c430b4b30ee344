"""Emergency stop, modes, motor faults and what stays latched, without a rover where that is enough."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command, Failsafe, Result, Severity, SystemState
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, CYCLE, DRIVER, NEUTRAL, Bench, said
from tests.vehicle.conversations import conversation
from tests.vehicle.safety.rig import Rig
from vehicle.safety.states import SafetyState

SWITCH, TERMINATE = Command.DO_SET_SAFETY_SWITCH_STATE, Command.DO_FLIGHTTERMINATION
FORCE = 21196


@pytest.mark.parametrize("second", ["command", "button"])
def test_a_second_emergency_stop_does_not_end_a_termination(second: str) -> None:
    bench = Bench()
    bench.drive()
    assert bench.command(TERMINATE, 1) is Result.ACCEPTED
    if second == "command":
        assert bench.command(SWITCH, 0) is Result.ACCEPTED
    else:
        bench.rover.update_estop_input("pressed", bench.now)
        bench.wait(CYCLE)
        bench.rover.update_estop_input(None, bench.now)
    assert bench.command(SWITCH, 1) is Result.FAILED
    assert bench.command(Command.COMPONENT_ARM_DISARM, 1, FORCE) is Result.FAILED
    bench.wait(0.1)
    assert said(bench, "release refused: terminated, restart the vehicle")
    assert bench.rover.state is SafetyState.ESTOP
    assert bench.newest(m.Heartbeat).system_status == SystemState.FLIGHT_TERMINATION


def test_manual_after_long_hold_does_not_disarm_for_old_demand() -> None:
    """Longer in HOLD than FS_DISARM_T, without a demand: the one before HOLD must not count in MANUAL."""
    bench = Bench()
    bench.drive()
    bench.wait(2.0, NEUTRAL)
    assert bench.set_mode(Mode.HOLD) is Result.ACCEPTED
    for _ in range(40):
        bench.heartbeat()
        bench.wait(1.0)
    assert bench.armed
    assert bench.set_mode(Mode.MANUAL) is Result.ACCEPTED
    bench.wait(1.0)
    assert bench.armed
    assert bench.mode is Mode.MANUAL
    assert not said(bench, "manual control lost")


def test_loop_overrun_is_latched_until_the_next_arming() -> None:
    bench = Bench()
    bench.drive()
    bench.freeze(0.25)
    bench.cycle()
    assert not bench.armed
    bench.wait(1.2)
    assert bench.newest(m.RoverFailsafeStatus).latched & Failsafe.LOOP_OVERRUN
    assert bench.arm() is Result.ACCEPTED
    bench.wait(1.2, NEUTRAL)
    assert not bench.newest(m.RoverFailsafeStatus).latched & Failsafe.LOOP_OVERRUN


class TestEmergencyStop:
    def test_it_is_reported_once_and_closes_everything(self) -> None:
        rig = Rig().armed()
        rig.safety.choose_mode(Mode.GUIDED, rig.now)
        rig.safety.emergency_stop("GCS 255", rig.now)
        assert rig.safety.state is SafetyState.ESTOP
        assert rig.safety.latched & Failsafe.ESTOP
        assert not rig.safety.autonomy_confirmed
        assert rig.severity("EMERGENCY STOP by GCS 255") is Severity.EMERGENCY
        rig.safety.emergency_stop("GCS 9", rig.now)
        assert not rig.said("GCS 9")
        assert not rig.safety.terminated

    def test_it_is_released_and_stays_disarmed(self) -> None:
        rig = Rig().armed()
        rig.safety.emergency_stop("GCS 255", rig.now)
        assert rig.safety.release_estop(rig.now) is None
        assert rig.safety.state is SafetyState.SAFE
        assert rig.safety.latched == 0
        assert rig.severity("released") is Severity.NOTICE

    def test_without_one_a_release_does_nothing(self) -> None:
        rig = Rig().armed()
        texts = len(rig.texts)
        assert rig.safety.release_estop(rig.now) is None
        assert rig.safety.armed
        assert len(rig.texts) == texts

    def test_while_its_input_stops_the_vehicle_it_is_not_released(self) -> None:
        rig = Rig().armed()
        rig.safety.update_estop_input("wire broken", rig.now)
        assert rig.safety.state is SafetyState.ESTOP
        assert rig.said("wire broken")
        assert rig.safety.release_estop(rig.now) == "wire broken"
        assert rig.safety.state is SafetyState.ESTOP
        rig.safety.update_estop_input(None, rig.now)
        assert rig.safety.state is SafetyState.ESTOP
        assert rig.safety.release_estop(rig.now) is None

    def test_a_motor_driver_that_failed_is_failed_after_the_release(self) -> None:
        rig = Rig().armed()
        rig.safety.emergency_stop("GCS 255", rig.now)
        rig.safety.motor_failed("no answer", rig.now)
        assert rig.safety.latched == Failsafe.ESTOP | Failsafe.MOTOR_DRIVER
        assert rig.safety.release_estop(rig.now) is None
        assert rig.safety.state is SafetyState.FAULT


class TestMode:
    def test_a_choice_is_reported_and_forgets_the_demand(self) -> None:
        rig = Rig().armed()
        rig.stick(AHEAD)
        generation = rig.safety.mode_generation
        assert rig.safety.choose_mode(Mode.GUIDED, rig.now) is None
        assert rig.safety.mode is rig.safety.intended is Mode.GUIDED
        assert rig.safety.mode_generation == generation + 1
        assert rig.control.demand is None
        assert rig.severity("Mode GUIDED") is Severity.INFO

    def test_same_mode_keeps_the_demand_and_restarts_self_driving(self) -> None:
        rig = Rig().armed()
        rig.stick(AHEAD)
        generation = rig.safety.mode_generation
        texts = len(rig.texts)
        assert rig.safety.choose_mode(Mode.MANUAL, rig.now) is None
        assert rig.control.neutral_seen
        assert rig.control.demand is not None
        assert rig.safety.mode_generation == generation + 1
        assert len(rig.texts) == texts

    def test_hold_keeps_the_demand_and_needs_neutral(self) -> None:
        rig = Rig().armed()
        rig.stick(AHEAD)
        assert rig.safety.choose_mode(Mode.HOLD, rig.now) is None
        assert rig.control.demand is not None
        assert not rig.control.neutral_seen

    def test_a_mode_that_cannot_work_is_refused(self) -> None:
        rig = Rig().armed()
        rig.ready.unready[Mode.AUTO] = "no mission"
        assert rig.safety.choose_mode(Mode.AUTO, rig.now) == "no mission"
        assert rig.safety.mode is rig.safety.intended is Mode.MANUAL

    def test_a_critical_battery_blocks_modes_that_move(self) -> None:
        rig = Rig(FS_GCS_ENABLE=0).armed()
        rig.safety.battery.update(9.0, rig.now)
        rig.cycle(3.1)
        assert rig.safety.choose_mode(Mode.MANUAL, rig.now) == "battery critical"
        assert rig.safety.choose_mode(Mode.HOLD, rig.now) is None

    def test_hold_does_not_acknowledge_a_failsafe_and_the_others_do(self) -> None:
        for mode, latched in ((Mode.HOLD, Failsafe.BLOCKED), (Mode.MANUAL, Failsafe(0)), (Mode.GUIDED, Failsafe(0))):
            rig = Rig().armed()
            rig.endure(Failsafe.BLOCKED)
            assert rig.safety.latched == Failsafe.BLOCKED
            assert rig.safety.choose_mode(mode, rig.now) is None
            assert rig.safety.latched == latched

    def test_self_driving_is_confirmed_while_armed_only(self) -> None:
        rig = Rig()
        rig.cycle()
        rig.safety.confirm_autonomy()
        assert not rig.safety.autonomy_confirmed
        rig.armed()
        rig.safety.confirm_autonomy()
        assert rig.safety.autonomy_confirmed

    def test_the_end_of_self_driving_is_hold_and_is_reported(self) -> None:
        rig = Rig().armed()
        rig.safety.choose_mode(Mode.GUIDED, rig.now)
        rig.stick(NEUTRAL)
        generation = rig.safety.mode_generation
        rig.safety.finish_autonomy("arrived", rig.now)
        assert rig.severity("GUIDED: arrived: HOLD") is Severity.NOTICE
        assert rig.safety.mode is Mode.HOLD
        assert rig.safety.intended is Mode.GUIDED
        assert not rig.safety.autonomy_confirmed
        assert not rig.control.neutral_seen
        assert rig.safety.mode_generation == generation + 1


class TestMotorDriver:
    def test_a_failure_is_reported_once_with_the_newest_reason_kept(self) -> None:
        rig = Rig().armed()
        rig.safety.motor_failed("no answer", rig.now)
        rig.safety.motor_failed("wrong answer", rig.now)
        assert rig.safety.state is SafetyState.FAULT
        assert rig.safety.motor_fault == "wrong answer"
        assert rig.severity("no answer") is Severity.CRITICAL
        assert not rig.said("wrong answer")
        assert rig.safety.latched == Failsafe.MOTOR_DRIVER

    def test_its_repair_is_reported_where_it_had_failed(self) -> None:
        rig = Rig()
        rig.cycle()
        rig.safety.motor_repaired(rig.now)
        assert rig.texts == []
        rig.safety.motor_failed("no answer", rig.now)
        rig.safety.motor_repaired(rig.now)
        assert rig.severity("recovered") is Severity.NOTICE
        assert rig.safety.state is SafetyState.SAFE
        assert rig.safety.motor_fault is None
        assert rig.safety.latched == 0


def test_shutdown_is_the_end() -> None:
    rig = Rig().armed()
    rig.safety.shutdown()
    assert rig.safety.state is SafetyState.OFF
    assert rig.safety.arm(conversation(DRIVER), rig.now, force=True) != []


def test_an_overrun_of_the_loop_is_reported_with_its_length() -> None:
    rig = Rig().armed()
    rig.safety.handle_loop_overrun(0.256, rig.now)
    assert rig.said("Disarmed: control loop was 0.26 s late")
    assert rig.safety.latched == Failsafe.LOOP_OVERRUN


def test_an_overrun_is_cleared_by_the_next_arming() -> None:
    rig = Rig().armed()
    rig.safety.handle_loop_overrun(0.3, rig.now)
    assert rig.safety.latched == Failsafe.LOOP_OVERRUN
    assert rig.safety.arm(conversation(DRIVER), rig.now) == []
    assert not rig.safety.latched


def test_all_that_is_latched_is_reported_together() -> None:
    rig = Rig().armed()
    rig.endure(Failsafe.BLOCKED)
    rig.safety.handle_loop_overrun(0.3, rig.now)
    assert rig.safety.latched == Failsafe.BLOCKED | Failsafe.LOOP_OVERRUN
    rig.safety.motor_failed("no answer", rig.now)
    rig.safety.emergency_stop("GCS 255", rig.now)
    everything = Failsafe.BLOCKED | Failsafe.LOOP_OVERRUN | Failsafe.MOTOR_DRIVER | Failsafe.ESTOP
    assert rig.safety.latched == everything


def test_without_an_owner_none_is_released() -> None:
    rig = Rig()
    rig.cycle()
    rig.now += 60.0
    rig.safety.free_lost_owner(rig.now)
    assert rig.texts == []
