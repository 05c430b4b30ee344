"""The two silences: no demand, and no ground station. Each test first shows the wheels turning."""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.enums import Command, Failsafe, Result, SystemState
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, CYCLE, NEUTRAL, OTHER, Bench, said


def beats(bench: Bench, seconds: float) -> None:
    """The driver's ground station lives but sends no demand."""
    for _ in range(round(seconds)):
        bench.heartbeat()
        bench.wait(1.0)


class TestManualLoss:
    def test_outputs_begin_to_fall_within_half_a_second_and_end_within_one(self) -> None:
        bench = Bench()
        bench.drive()
        bench.stick(AHEAD)
        last, began, ended = bench.now, math.inf, math.inf
        while bench.now < last + 2.0:
            bench.wait(CYCLE)
            if min(bench.throttles) < 1.0:
                began = min(began, bench.now - last)
            if not bench.turning:
                ended = min(ended, bench.now - last)
        assert 0.44 < began <= 0.5
        assert ended <= 0.9
        assert said(bench, "manual control lost: stopping")

    def test_a_demand_just_too_late_is_too_late_also_before_the_cycle_that_would_see_it(self) -> None:
        bench = Bench()
        bench.drive()
        bench.stick(AHEAD)
        bench.wait(0.45)
        bench.now += 0.005
        bench.stick(AHEAD)
        bench.wait(0.6, AHEAD)
        assert not bench.turning

    def test_it_falls_without_rising_again(self) -> None:
        bench = Bench()
        bench.drive()
        bench.wait(0.44)
        seen = [bench.throttles[0]]
        while bench.turning:
            bench.wait(CYCLE)
            seen.append(bench.throttles[0])
        assert seen == sorted(seen, reverse=True)
        assert not bench.rover.outputs.enabled

    def test_with_the_link_back_nothing_moves_before_a_neutral(self) -> None:
        bench = Bench()
        bench.drive()
        bench.wait(1.0)
        assert not bench.turning
        bench.wait(0.5, AHEAD)
        assert not bench.turning
        bench.wait(0.1, NEUTRAL)
        bench.wait(0.1, AHEAD)
        assert bench.turning  # HOLD was not due yet

    def test_hold_then_disarm(self) -> None:
        bench = Bench()
        bench.drive()
        lost = bench.now + 0.45
        bench.wait(1.8)
        assert bench.newest(m.Heartbeat).custom_mode == Mode.MANUAL
        assert bench.newest(m.RoverFailsafeStatus).active == Failsafe.MANUAL_LOSS
        bench.wait(0.3)
        assert bench.newest(m.Heartbeat).custom_mode == Mode.HOLD
        assert bench.newest(m.Heartbeat).system_status == SystemState.CRITICAL
        beats(bench, 27)
        assert bench.armed
        bench.wait(lost + 30.1 - bench.now)
        assert not bench.armed
        assert said(bench, "Disarmed: manual control lost")

    def test_a_bystander_who_holds_it_does_not_end_the_countdown(self) -> None:
        bench = Bench(FS_DISARM_T=10)
        bench.drive()
        bench.wait(3.0)
        assert bench.command(Command.DO_SET_MODE, 1, Mode.HOLD, system=OTHER) is Result.ACCEPTED
        beats(bench, 8)
        assert not bench.armed

    def test_after_hold_the_driver_has_to_choose_a_mode(self) -> None:
        bench = Bench()
        bench.drive()
        bench.wait(2.2)
        bench.wait(0.2, NEUTRAL)
        bench.wait(0.5, AHEAD)
        assert not bench.turning
        assert bench.newest(m.Heartbeat).system_status == SystemState.CRITICAL  # latched
        assert bench.set_mode(Mode.MANUAL) is Result.ACCEPTED
        bench.wait(0.5, AHEAD)
        assert not bench.turning
        bench.wait(0.1, NEUTRAL)
        bench.wait(0.1, AHEAD)
        assert bench.turning
        assert bench.newest(m.Heartbeat).system_status == SystemState.ACTIVE

    def test_the_countdown_is_told(self) -> None:
        bench = Bench()
        bench.drive()
        bench.wait(0.5)
        told = bench.newest(m.RoverFailsafeStatus)
        assert told.active == Failsafe.MANUAL_LOSS
        assert 1200 <= told.action_in_ms <= 1500
        assert told.custom_mode_after == Mode.HOLD
        assert not told.will_disarm
        bench.wait(3.0)
        told = bench.newest(m.RoverFailsafeStatus)
        assert told.latched == Failsafe.MANUAL_LOSS
        assert told.will_disarm

    def test_a_driver_at_rest_may_lose_two_frames_and_still_drive_on(self) -> None:
        bench = Bench()
        bench.drive()
        bench.wait(1.0, NEUTRAL)
        bench.texts.clear()
        bench.wait(1.0)  # 5 Hz, and two lost in a row
        bench.wait(0.1, AHEAD)
        assert bench.turning
        assert bench.texts == []

    def test_a_driver_at_rest_who_is_gone_ends_in_hold(self) -> None:
        bench = Bench()
        bench.drive()
        bench.wait(1.0, NEUTRAL)
        bench.wait(2.2)
        assert bench.mode is Mode.HOLD

    def test_armed_without_any_demand_yet_is_no_loss(self) -> None:
        bench = Bench()
        bench.arm()
        beats(bench, 20)
        assert bench.armed
        assert bench.mode is Mode.MANUAL

    def test_20_hz_with_eight_frames_lost_in_a_row_drives_on(self) -> None:
        bench = Bench()
        bench.drive()
        bench.stick(AHEAD)
        bench.wait(0.44)
        bench.stick(AHEAD)
        bench.wait(0.2, AHEAD)
        assert bench.throttles == (1.0, 1.0)

    def test_dead_man_time_is_a_parameter(self) -> None:
        bench = Bench(MAN_TIMEOUT=1.0)
        bench.drive()
        bench.wait(0.9)
        assert bench.throttles == (1.0, 1.0)
        bench.wait(0.7)
        assert not bench.turning


class TestGroundStationLoss:
    def test_hold_then_disarm_and_free(self) -> None:
        bench = Bench(FS_DISARM_T=300)
        bench.drive()
        silent = bench.now
        bench.wait(4.5)
        assert not said(bench, "ground station lost")
        bench.wait(1.0)
        assert said(bench, "ground station lost: HOLD")
        assert bench.mode is Mode.HOLD
        bench.wait(silent + 64.5 - bench.now)
        assert bench.armed
        bench.wait(1.0)
        assert not bench.armed
        assert bench.newest(m.ControlStatus).gcs_main == 0

    def test_any_message_of_the_owner_is_life(self) -> None:
        bench = Bench()
        bench.arm()
        for _ in range(4):
            bench.wait(4.0)
            bench.say(m.Timesync(tc1=0, ts1=1))
        assert not said(bench, "ground station lost")

    def test_messages_of_others_are_not(self) -> None:
        bench = Bench()
        bench.arm()
        for _ in range(6):
            bench.wait(1.0)
            bench.heartbeat(system=9)
            bench.heartbeat(introduced=False)
        assert said(bench, "ground station lost: HOLD")

    def test_it_can_be_turned_off(self) -> None:
        bench = Bench(FS_GCS_ENABLE=0)
        bench.arm()
        bench.wait(10.0)
        assert bench.mode is Mode.MANUAL

    def test_heartbeat_back_clears_and_the_mode_stays(self) -> None:
        bench = Bench()
        bench.arm()
        bench.wait(6.0)
        assert bench.mode is Mode.HOLD
        bench.heartbeat()
        bench.wait(1.2)
        assert bench.newest(m.RoverFailsafeStatus).active == 0
        assert bench.mode is Mode.HOLD
        assert said(bench, "Failsafe cleared: ground station lost")
