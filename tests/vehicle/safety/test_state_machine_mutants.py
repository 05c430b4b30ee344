"""Arming, mode changes and the emergency stop: what a second command must not undo."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command, Failsafe, Result, SystemState
from dialects.modes import Mode
from tests.vehicle.bench import CYCLE, NEUTRAL, Bench, said
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


def test_manual_after_a_long_hold_is_not_disarmed_for_the_old_demand() -> None:
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
