"""Failsafe conditions and rules: each test first shows the wheels turning, then that and when they stop."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import replace

from dialects import messages as m
from dialects.enums import Command, Failsafe, Result, SystemState
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, CYCLE, EVERYTHING, NEUTRAL, OTHER, Bench, said
from vehicle.safety.failsafe import RULES, FailsafeAction


def beats(bench: Bench, seconds: float) -> None:
    """Send heartbeats of the ground station in control, but no demand."""
    for _ in range(round(seconds)):
        bench.heartbeat()
        bench.wait(1.0)


class TestManualLoss:
    def test_outputs_begin_to_fall_within_half_second_and_end_in_one(self) -> None:
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

    def test_demand_after_the_timeout_is_stale_before_the_next_cycle(self) -> None:
        bench = Bench()
        bench.drive()
        bench.stick(AHEAD)
        bench.wait(0.45)
        bench.now += 0.005
        bench.stick(AHEAD)
        bench.wait(0.6, AHEAD)
        assert not bench.turning

    def test_the_outputs_fall_without_rising_again(self) -> None:
        bench = Bench()
        bench.drive()
        bench.wait(0.44)
        seen = [bench.throttles[0]]
        while bench.turning:
            bench.wait(CYCLE)
            seen.append(bench.throttles[0])
        assert seen == sorted(seen, reverse=True)
        assert not bench.rover.outputs.enabled

    def test_after_the_link_returns_neutral_comes_first(self) -> None:
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

    def test_hold_from_another_station_does_not_end_the_countdown(self) -> None:
        bench = Bench(FS_DISARM_T=10)
        bench.drive()
        bench.wait(3.0)
        assert bench.command(Command.DO_SET_MODE, 1, Mode.HOLD, system=OTHER) is Result.ACCEPTED
        beats(bench, 8)
        assert not bench.armed

    def test_after_hold_the_operator_has_to_choose_a_mode(self) -> None:
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

    def test_the_countdown_is_reported(self) -> None:
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

    def test_an_idle_operator_may_lose_two_frames(self) -> None:
        bench = Bench()
        bench.drive()
        bench.wait(1.0, NEUTRAL)
        bench.texts.clear()
        bench.wait(1.0)  # 5 Hz, and two lost in a row
        bench.wait(0.1, AHEAD)
        assert bench.turning
        assert bench.texts == []

    def test_an_idle_operator_who_disappears_causes_hold(self) -> None:
        bench = Bench()
        bench.drive()
        bench.wait(1.0, NEUTRAL)
        bench.wait(2.2)
        assert bench.mode is Mode.HOLD

    def test_armed_without_any_demand_does_not_trigger_manual_loss(self) -> None:
        bench = Bench()
        bench.arm()
        beats(bench, 20)
        assert bench.armed
        assert bench.mode is Mode.MANUAL

    def test_20_hz_with_eight_lost_frames_keeps_driving(self) -> None:
        bench = Bench()
        bench.drive()
        bench.stick(AHEAD)
        bench.wait(0.44)
        bench.stick(AHEAD)
        bench.wait(0.2, AHEAD)
        assert bench.throttles == (1.0, 1.0)

    def test_dead_man_time_is_a_parameter(self) -> None:
        bench = Bench(MAN_TIMEOUT=1.0, FRESH_DIST=0)
        bench.drive()
        bench.wait(0.9)
        assert bench.throttles == (1.0, 1.0)
        bench.wait(0.7)
        assert not bench.turning


class TestGroundStationLoss:
    def test_gcs_loss_holds_then_disarms_and_releases_control(self) -> None:
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

    def test_any_message_of_the_owner_prevents_the_gcs_failsafe(self) -> None:
        bench = Bench()
        bench.arm()
        for _ in range(4):
            bench.wait(4.0)
            bench.say(m.Timesync(tc1=0, ts1=1))
        assert not said(bench, "ground station lost")

    def test_messages_of_others_do_not_prevent_the_gcs_failsafe(self) -> None:
        bench = Bench()
        bench.arm()
        for _ in range(6):
            bench.wait(1.0)
            bench.heartbeat(system=9)
            bench.heartbeat(introduced=False)
        assert said(bench, "ground station lost: HOLD")

    def test_the_gcs_failsafe_can_be_disabled(self) -> None:
        bench = Bench(FS_GCS_ENABLE=0)
        bench.arm()
        bench.wait(10.0)
        assert bench.mode is Mode.MANUAL

    def test_returning_heartbeat_clears_failsafe_but_not_the_mode(self) -> None:
        bench = Bench()
        bench.arm()
        bench.wait(6.0)
        assert bench.mode is Mode.HOLD
        bench.heartbeat()
        bench.wait(1.2)
        assert bench.newest(m.RoverFailsafeStatus).active == 0
        assert bench.mode is Mode.HOLD
        assert said(bench, "Failsafe cleared: ground station lost")


SAFETY = Path(__file__).parents[3] / "docs" / "safety.md"


class TestSensors:
    def test_tilted_disarms(self) -> None:
        bench = Bench()
        bench.readings = EVERYTHING
        bench.drive()
        bench.readings = replace(EVERYTHING, roll=-0.9)
        bench.wait(0.4, AHEAD)
        assert bench.turning
        bench.wait(0.2, AHEAD)
        assert not bench.armed
        assert said(bench, "Disarmed: tilted")

    @pytest.mark.parametrize(("check", "armed"), [(1, True), (2, False)])
    def test_blocked_holds(self, check: int, armed: bool) -> None:
        bench = Bench(FS_CRASH_CHECK=check)
        bench.readings = EVERYTHING
        bench.drive()
        bench.readings = replace(EVERYTHING, wheel_speeds=(0.01, 0.0))
        bench.wait(1.9, AHEAD)
        assert bench.turning
        bench.wait(0.8, AHEAD)
        assert not bench.turning
        assert bench.armed is armed
        assert not armed or bench.mode is Mode.HOLD
        assert bench.newest(m.RoverFailsafeStatus).latched & Failsafe.BLOCKED

    @pytest.mark.parametrize("change", [{"wheel_speeds": (0.0, 0.0)}, {"roll": -0.9}])
    def test_a_short_tilt_or_standstill_is_not_reported(self, change: dict[str, Any]) -> None:
        """Each start and each change of direction includes a short standstill, and a stone tilts the rover."""
        bench = Bench()
        bench.readings = EVERYTHING
        bench.drive()
        bench.texts.clear()
        for _ in range(3):
            bench.readings = replace(EVERYTHING, **change)
            bench.wait(0.4, AHEAD)
            status = bench.newest(m.RoverFailsafeStatus)
            assert (status.active, status.action_in_ms) == (0, 65535)
            bench.readings = EVERYTHING
            bench.wait(1.2, AHEAD)
        assert bench.turning
        assert not said(bench, "Failsafe")
        assert {beat.system_status for beat in bench.all(m.Heartbeat)[-4:]} == {SystemState.ACTIVE}

    def test_tilt_and_blocked_can_be_disabled(self) -> None:
        bench = Bench(FS_CRASH_CHECK=0, CRASH_ANGLE=0)
        bench.readings = replace(EVERYTHING, roll=2.0, wheel_speeds=(0.0, 0.0))
        bench.drive()
        bench.wait(5.0, AHEAD)
        assert bench.turning


class TestRules:
    def test_the_table_of_the_documentation_has_every_rule(self) -> None:
        documented = SAFETY.read_text(encoding="utf-8")
        for rule in RULES.values():
            assert f"| {rule.label} | {rule.help} |" in documented

    def test_every_rule_has_a_label_and_steps(self) -> None:
        for rule in RULES.values():
            assert rule.label
            assert rule.steps
            assert all(step.action in FailsafeAction for step in rule.steps)
