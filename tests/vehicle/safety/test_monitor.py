"""SafetyMonitor: a late loop, NaN, permission to move, and automatic disarming."""

from __future__ import annotations

import pytest

from dialects.enums import Failsafe, Result, Severity
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, DRIVER, NEUTRAL, Bench, said
from tests.vehicle.conversations import conversation
from tests.vehicle.safety.rig import STANDING, START, Rig
from vehicle.drive.demand import Demand
from vehicle.drive.gate import MotorTest, Outputs
from vehicle.drive.operator_session import DrivingSession
from vehicle.safety.monitor import BAD_CYCLES_MAX, LATE_CYCLE_TIME
from vehicle.safety.states import SafetyState

ZERO = Outputs((0.0, 0.0), enabled=False)


class TestLoop:
    def test_a_late_cycle_zeroes_the_outputs(self) -> None:
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
    def test_a_stalled_control_loop_disarms(self, first: str) -> None:
        """Also when a demand that waited in the socket comes before the first cycle."""
        bench = Bench()
        bench.drive()
        bench.freeze(0.25)
        bench.cycle() if first == "tick" else bench.stick(AHEAD)
        assert bench.rover.outputs == ZERO
        assert not bench.armed
        bench.wait(0.1)
        assert said(bench, "Disarmed: control loop was 0.25 s late")

    def test_the_loop_timeout_is_a_parameter(self) -> None:
        bench = Bench(FS_LOOP_TIMEOUT=1.0)
        bench.drive()
        bench.freeze(0.9)
        bench.cycle()
        assert bench.armed
        assert not bench.turning


class TestIdle:
    def test_an_idle_rover_disarms_after_disarm_delay(self) -> None:
        bench = Bench(DISARM_DELAY=20)
        bench.drive()
        bench.wait(15.0, NEUTRAL, period=0.2)
        assert bench.armed
        bench.wait(6.0, NEUTRAL, period=0.2)
        assert not bench.armed
        assert said(bench, "Disarmed: no demand for 20 s")


def test_a_cycle_that_is_left_out_makes_the_next_one_no_later() -> None:
    monitor = Bench().rover._monitor
    for step in range(50):
        monitor.skip_cycle(100.0 + step)
        assert not monitor.is_late(100.02 + step)
    assert monitor.is_late(150.0)


def demand(time: float) -> Demand:
    return Demand(0.5, 0.0, time, DRIVER, 0)


class TestLate:
    def test_a_cycle_is_late_after_a_tenth_of_a_second(self) -> None:
        assert LATE_CYCLE_TIME == 0.1
        rig = Rig(FS_LOOP_TIMEOUT=0.5)
        rig.monitor.update(0.0, 0, STANDING, driving=False)
        assert not rig.monitor.is_late(LATE_CYCLE_TIME)
        assert rig.monitor.is_late(LATE_CYCLE_TIME + 0.001)

    def test_the_start_counts_as_a_cycle(self) -> None:
        rig = Rig()
        assert not rig.monitor.is_late(START + 0.09)
        assert rig.monitor.is_late(START + 0.11)

    def test_a_much_too_late_one_disarms_beyond_its_limit(self) -> None:
        rig = Rig(FS_LOOP_TIMEOUT=0.5).armed()
        rig.monitor.update(128.0, 0, STANDING, driving=False)
        assert rig.monitor.is_late(128.5)
        assert rig.safety.armed
        assert rig.monitor.is_late(128.51)
        assert not rig.safety.armed
        assert rig.safety.latched & Failsafe.LOOP_OVERRUN

    def test_a_disarmed_vehicle_has_no_overrun(self) -> None:
        rig = Rig()
        rig.cycle()
        assert rig.monitor.is_late(rig.now + 10.0)
        assert rig.safety.latched == 0


class TestCycle:
    def test_the_first_ends_boot(self) -> None:
        rig = Rig()
        assert rig.safety.state.value == "boot"
        rig.cycle()
        assert rig.safety.state is SafetyState.SAFE

    def test_a_demand_that_went_stale_needs_neutral_again(self) -> None:
        rig = Rig(MAN_TIMEOUT=0.5).armed()
        rig.stick(AHEAD)
        rig.cycle(0.5)
        assert rig.control.neutral_seen
        rig.cycle(0.01)
        assert not rig.control.neutral_seen

    def test_a_stale_demand_needs_neutral_even_without_a_failsafe(self) -> None:
        rig = Rig(MAN_TIMEOUT=0.5).armed()
        assert rig.safety.choose_mode(Mode.GUIDED, rig.now) is None
        rig.stick(NEUTRAL)
        rig.stick(AHEAD)
        assert rig.control.neutral_seen
        rig.cycle(0.51)
        assert not rig.control.neutral_seen
        assert rig.safety.failsafes.active == 0

    def test_nan_three_times_in_a_row_is_hold(self) -> None:
        assert BAD_CYCLES_MAX == 3
        rig = Rig(FS_GCS_ENABLE=0).armed()
        rig.cycle(refused=2)
        assert rig.safety.mode.name == "MANUAL"
        rig.cycle(refused=3)
        assert rig.safety.mode is Mode.HOLD
        assert [severity for severity, text in rig.texts if "not numbers" in text] == [Severity.CRITICAL]
        generation = rig.safety.mode_generation
        rig.cycle(5.0, refused=4)
        assert rig.safety.mode_generation == generation
        assert len([text for _, text in rig.texts if "not numbers" in text]) == 1

    @pytest.mark.parametrize(("mode", "held"), [(Mode.MANUAL, False), (Mode.GUIDED, True)])
    def test_an_autonomous_mode_does_not_outlive_a_succession(self, mode: Mode, held: bool) -> None:
        rig = Rig(FS_GCS_TIMEOUT=5, FS_GCS_ENABLE=0).armed()
        assert rig.safety.choose_mode(mode, rig.now) is None
        driver = rig.control.ownership.driver
        assert driver is not None
        driver.session = DrivingSession(7)
        rig.now += 5.1
        assert [rig.stick(NEUTRAL) for _ in range(3)] == [False, False, True]
        rig.cycle()
        assert (rig.safety.mode is Mode.HOLD) is held

    def test_a_disarmed_vehicle_stays_in_its_mode(self) -> None:
        rig = Rig()
        rig.cycle()
        rig.cycle(refused=5)
        assert rig.safety.mode is Mode.MANUAL

    def test_a_disarmed_vehicle_is_not_kept_by_a_silent_owner(self) -> None:
        rig = Rig(FS_GCS_TIMEOUT=5, FS_GCS_ENABLE=0, DISARM_DELAY=0).armed()
        rig.cycle(5.1)
        assert rig.control.ownership.owner == DRIVER  # armed
        rig.safety.disarm("by GCS", rig.now - 1.0)
        assert rig.control.ownership.owner == DRIVER
        rig.cycle()
        assert rig.control.ownership.owner == 0


class TestClearance:
    def test_a_driver_in_manual(self) -> None:
        rig = Rig(MAN_TIMEOUT=0.5).armed()
        rig.stick(AHEAD)
        rig.now += 0.25
        trial = MotorTest(1, 0, 0.1)
        clearance = rig.monitor.build_clearance(rig.now, demand(0.0), late=True, trial=trial)
        assert clearance == (True, True, False, True, 0.25, 0.5, trial)
        rig.control.require_neutral()
        clearance = rig.monitor.build_clearance(rig.now, None, late=False)
        assert clearance == (True, False, False, False, 0.25, 0.5, None)

    def test_self_driving(self) -> None:
        rig = Rig().armed()
        assert rig.safety.choose_mode(Mode.GUIDED, rig.now) is None
        now = 128.0
        own = demand(127.5)
        assert rig.monitor.build_clearance(now, own, late=False) == (
            True,
            False,
            False,
            True,
            0.5,
            LATE_CYCLE_TIME,
            None,
        )
        assert rig.monitor.build_clearance(now, None, late=False).demand_age is None
        rig.safety.disarm("by GCS", now)
        clearance = rig.monitor.build_clearance(now, own, late=False)
        assert (clearance.armed, clearance.neutral_seen) == (False, False)

    def test_a_mode_without_motion_holds(self) -> None:
        rig = Rig().armed()
        assert not rig.monitor.build_clearance(rig.now, None, late=False).held
        rig.safety.hold()
        assert rig.monitor.build_clearance(rig.now, None, late=False).held

    @pytest.mark.parametrize(("cause", "held"), [(Failsafe.POSITION, True), (Failsafe.FENCE, False)])
    def test_a_failsafe_that_wants_neutral_holds(self, cause: Failsafe, held: bool) -> None:
        rig = Rig(FENCE_ACTION=0).armed()
        rig.cycle(cause=cause)
        assert rig.safety.mode is Mode.MANUAL
        assert rig.monitor.build_clearance(rig.now, None, late=False).held is held


class TestFailsafes:
    def test_neutral_closes_the_interlock_and_keeps_the_mode(self) -> None:
        rig = Rig().armed()
        rig.cycle(cause=Failsafe.POSITION)
        assert not rig.control.neutral_seen
        assert rig.safety.mode is Mode.MANUAL
        assert rig.severity("Failsafe: ") is Severity.WARNING

    def test_a_warning_stops_nothing(self) -> None:
        rig = Rig(FENCE_ACTION=0).armed()
        rig.cycle(cause=Failsafe.FENCE)
        assert rig.control.neutral_seen
        assert rig.severity("Failsafe: ") is Severity.WARNING

    @pytest.mark.parametrize(
        ("cause", "severity"), [(Failsafe.BLOCKED, Severity.CRITICAL), (Failsafe.TILT, Severity.CRITICAL)]
    )
    def test_hold_and_disarm_are_critical(self, cause: Failsafe, severity: Severity) -> None:
        rig = Rig().armed()
        rig.endure(cause)
        assert rig.severity("Failsafe: ") is severity
        assert rig.safety.armed == (cause is Failsafe.BLOCKED)
        assert (rig.safety.mode is Mode.HOLD) == (cause is Failsafe.BLOCKED)

    def test_the_way_home_begins_where_it_can(self) -> None:
        rig = Rig(FENCE_ACTION=1).armed()
        rig.cycle(cause=Failsafe.FENCE)
        assert rig.safety.mode is Mode.RTL
        assert rig.safety.autonomy_confirmed

    def test_and_is_hold_where_it_cannot(self) -> None:
        rig = Rig(FENCE_ACTION=1).armed()
        rig.ready.unready[Mode.RTL] = "there is no home"
        rig.cycle(cause=Failsafe.FENCE)
        assert rig.safety.mode is Mode.HOLD

    def test_of_steps_at_the_same_moment_the_worst_is_taken(self) -> None:
        rig = Rig(FS_CRASH_CHECK=2).armed()
        rig.endure(Failsafe.BLOCKED)
        assert not rig.safety.armed
        assert rig.safety.mode is Mode.MANUAL
        assert len([text for _, text in rig.texts if text.startswith("Failsafe: ")]) == 1

    def test_its_end_is_reported_while_armed_only(self) -> None:
        rig = Rig(FENCE_ACTION=0).armed()
        rig.cycle(cause=Failsafe.FENCE)
        rig.cycle(cause=Failsafe.FENCE)
        assert not rig.said("Failsafe cleared")
        rig.cycle()
        assert rig.severity("Failsafe cleared") is Severity.NOTICE
        assert sum("Failsafe cleared" in text for _, text in rig.texts) == 1
        rig.cycle(10.0, cause=Failsafe.POSITION)
        rig.safety.disarm("by GCS", rig.now)
        rig.cycle()
        assert rig.safety.failsafes.active == 0
        assert sum("Failsafe cleared" in text for _, text in rig.texts) == 1

    def test_which_modes_may_go_on_alone(self) -> None:
        for mode in (Mode.MANUAL, Mode.RTL, Mode.GUIDED, Mode.LOITER, Mode.AUTO):
            rig = Rig(FS_GCS_ENABLE=2, FS_GCS_TIMEOUT=5, MAN_TIMEOUT=2).armed(neutral=False)
            assert rig.safety.choose_mode(mode, rig.now) is None
            rig.cycle(6.0)
            assert (rig.safety.mode is Mode.HOLD) == (mode is not Mode.AUTO)


class TestDisarmDelay:
    def test_the_delay_begins_with_arming_and_not_with_the_start(self) -> None:
        bench = Bench(DISARM_DELAY=20)
        bench.wait(60.0)
        assert bench.arm() is Result.ACCEPTED
        bench.wait(19.0, NEUTRAL, period=0.2)
        assert bench.armed
        bench.wait(2.0, NEUTRAL, period=0.2)
        assert not bench.armed
        assert said(bench, "Disarmed: no demand for 20 s")

    def rig(self, delay: float) -> Rig:
        """Armed at 160.0."""
        rig = Rig(DISARM_DELAY=delay, FS_GCS_ENABLE=0)
        rig.cycle(60.0)
        assert rig.now == 160.0
        assert rig.safety.arm(conversation(DRIVER), rig.now) == []
        return rig

    def test_it_disarms_after_the_delay(self) -> None:
        rig = self.rig(20)
        rig.cycle(20.0)
        assert rig.safety.armed
        rig.cycle(0.01)
        assert not rig.safety.armed

    def test_zero_is_never(self) -> None:
        rig = self.rig(0)
        rig.cycle(5000.0)
        assert rig.safety.armed

    def test_motion_demand_restarts_the_delay_and_a_neutral_does_not(self) -> None:
        rig = self.rig(20)
        rig.now += 10.0
        rig.stick(NEUTRAL)
        rig.stick(AHEAD)
        rig.cycle(0.0)
        rig.stick(NEUTRAL)
        rig.cycle(10.0)
        rig.safety.hold()  # a neutral demand is not lost there
        rig.cycle(10.0)
        assert rig.safety.armed
        rig.cycle(0.01)
        assert not rig.safety.armed

    def test_driving_by_itself_restarts_it(self) -> None:
        rig = self.rig(20)
        rig.cycle(10.0, driving=True)
        rig.cycle(20.0)
        assert rig.safety.armed
        rig.cycle(0.01)
        assert not rig.safety.armed
