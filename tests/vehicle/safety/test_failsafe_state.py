"""The steps of the failsafes, without a rover."""

from __future__ import annotations

from dialects.enums import Failsafe
from tests.vehicle.bench import CYCLE
from vehicle.params import Params
from vehicle.safety.failsafe import FailsafeAction
from vehicle.safety.failsafe_state import Failsafes


def test_the_worst_action_wins() -> None:
    failsafes = Failsafes(Params())
    failsafes.update({Failsafe.BATTERY_LOW: 0.0}, 0.0)
    assert failsafes.lasting_action(0.0) is FailsafeAction.LIMIT
    failsafes.update({Failsafe.BATTERY_LOW: 0.0, Failsafe.MANUAL_LOSS: 0.0}, 0.0)
    assert failsafes.lasting_action(0.0) is FailsafeAction.NEUTRAL


def test_each_step_is_taken_once() -> None:
    failsafes = Failsafes(Params())
    taken = [
        step.action for cycle in range(2000) for step in failsafes.update({Failsafe.MANUAL_LOSS: 0.0}, cycle * CYCLE)
    ]
    assert taken == [FailsafeAction.NEUTRAL, FailsafeAction.HOLD, FailsafeAction.DISARM]


def test_a_condition_that_returns_restarts_its_steps() -> None:
    failsafes = Failsafes(Params())
    failsafes.update({Failsafe.GCS_LOSS: 0.0}, 0.0)
    failsafes.update({}, 1.0)
    assert failsafes.active == 0
    assert failsafes.latched == Failsafe.GCS_LOSS
    assert [step.action for step in failsafes.update({Failsafe.GCS_LOSS: 2.0}, 2.0)] == [FailsafeAction.HOLD]


def test_a_condition_before_its_first_step_is_not_quiet() -> None:
    failsafes = Failsafes(Params())
    assert failsafes.quiet
    failsafes.update({Failsafe.TILT: 10.0}, 10.1)  # acts after 0.5 s
    assert not failsafes.active
    assert not failsafes.quiet
    failsafes.update({}, 10.2)
    assert failsafes.quiet
