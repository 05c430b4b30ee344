"""Arming, what forbids it, and disarming, without a rover."""

from __future__ import annotations

import pytest

from dialects.enums import Failsafe, Severity
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, DRIVER, NEUTRAL, OTHER
from tests.vehicle.conversations import conversation
from tests.vehicle.safety.rig import Rig
from vehicle.readings import ComputerReadings
from vehicle.safety.states import SafetyState


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
