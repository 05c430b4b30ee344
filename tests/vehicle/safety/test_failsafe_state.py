"""Failsafes without a rover: begin, steps, latching, and the next step."""

from __future__ import annotations

import math

import pytest
from msgspec.structs import replace

from dialects.enums import Failsafe
from tests.rows import each_row
from tests.vehicle.bench import CYCLE
from tests.vehicle.conversations import conversation
from tests.vehicle.safety.rig import MOTIONS, STANDING, START, Rig
from vehicle.params import Params
from vehicle.safety.failsafe import RULES, FailsafeAction, FailsafeStep
from vehicle.safety.failsafe_inputs import FailsafeInputs, MotionInputs
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


WARN, LIMIT, NEUTRAL, RTL, HOLD, DISARM = FailsafeAction
PARAMS = Params({"FS_TIMEOUT": 1.5, "FS_DISARM_T": 30.0})
MANUAL_LOSS = {Failsafe.MANUAL_LOSS: 0.0}


def actions(failsafes: Failsafes, conditions: dict[Failsafe, float], now: float) -> list[FailsafeAction]:
    return [step.action for step in failsafes.update(conditions, now)]


def test_the_larger_number_is_the_worse_action() -> None:
    assert [action.value for action in FailsafeAction] == [0, 1, 2, 3, 4, 5]
    assert sorted(FailsafeAction) == [WARN, LIMIT, NEUTRAL, RTL, HOLD, DISARM]
    assert len({action.label for action in FailsafeAction}) == 6
    assert HOLD.label == "HOLD"
    assert DISARM.label == "disarmed"


@each_row(
    ("cause", "steps"),
    [
        (Failsafe.MANUAL_LOSS, [(0, NEUTRAL), (1.5, HOLD), (30, DISARM)]),
        (Failsafe.GCS_LOSS, [(0, HOLD), (60, DISARM)]),
        (Failsafe.OPERATOR, [(0, NEUTRAL), (1.5, HOLD), (30, DISARM)]),
        (Failsafe.BATTERY_LOW, [(0, LIMIT), (0, HOLD)]),
        (Failsafe.BATTERY_CRITICAL, [(0, HOLD), (10, DISARM)]),
        (Failsafe.OVERHEAT, [(0, LIMIT), (10, HOLD)]),
        (Failsafe.GUIDED_LOSS, [(0, NEUTRAL), (4, HOLD)]),
        (Failsafe.POSITION, [(0, NEUTRAL), (1, HOLD)]),
        (Failsafe.FENCE, [(0, WARN), (0, HOLD)]),
        (Failsafe.TILT, [(0.5, DISARM)]),
        (Failsafe.BLOCKED, [(2, HOLD)]),
    ],
)
def test_what_each_condition_comes_to_and_when_by_default(
    cause: Failsafe, steps: list[tuple[float, FailsafeAction]]
) -> None:
    failsafes, taken = Failsafes(Params()), list[tuple[float, FailsafeAction]]()
    for now in (
        -0.5,
        0.0,
        0.49,
        0.5,
        0.99,
        1.0,
        1.49,
        1.5,
        1.99,
        2.0,
        3.99,
        4.0,
        9.99,
        10.0,
        29.99,
        30.0,
        59.99,
        60.0,
        999.0,
    ):
        taken += [(now, step.action) for step in failsafes.update({cause: 0.0}, now)]
        assert all(step.cause is cause for step in failsafes.update({cause: 0.0}, now))
    assert taken == steps
    assert set(RULES) >= {cause}


@each_row(
    ("params", "cause", "taken"),
    [
        ({"FS_LOW_ACT": 0}, Failsafe.BATTERY_LOW, [LIMIT]),
        ({"FS_LOW_ACT": 2}, Failsafe.BATTERY_LOW, [LIMIT, HOLD]),
        ({"FS_PI_ACT": 1}, Failsafe.OVERHEAT, [LIMIT]),
        ({"FS_PI_ACT": 2}, Failsafe.OVERHEAT, [LIMIT, HOLD]),
        ({"FENCE_ACTION": 0}, Failsafe.FENCE, [WARN]),
        ({"FENCE_ACTION": 1}, Failsafe.FENCE, [WARN, RTL]),
        ({"FENCE_ACTION": 2}, Failsafe.FENCE, [WARN, HOLD]),
        ({"FS_CRASH_CHECK": 0}, Failsafe.BLOCKED, []),
        ({"FS_CRASH_CHECK": 1}, Failsafe.BLOCKED, [HOLD]),
        ({"FS_CRASH_CHECK": 2}, Failsafe.BLOCKED, [HOLD, DISARM]),
    ],
)
def test_what_is_a_parameter(params: dict[str, float], cause: Failsafe, taken: list[FailsafeAction]) -> None:
    failsafes = Failsafes(Params(params))
    assert actions(failsafes, {cause: 0.0}, -0.5) == []
    assert actions(failsafes, {cause: 0.0}, 999.0) == taken


def test_two_seconds_blocked_disarm_where_that_is_set() -> None:
    failsafes = Failsafes(Params({"FS_CRASH_CHECK": 2}))
    assert actions(failsafes, {Failsafe.BLOCKED: 0.0}, 1.99) == []
    assert actions(failsafes, {Failsafe.BLOCKED: 0.0}, 2.0) == [HOLD, DISARM]


def test_only_a_critical_battery_blocks_modes() -> None:
    for cause in RULES:
        failsafes = Failsafes(PARAMS)
        failsafes.update({cause: 0.0}, 0.0)
        blocked = cause if cause is Failsafe.BATTERY_CRITICAL else Failsafe(0)
        assert failsafes.mode_blocking_conditions() == blocked
    assert Failsafes(PARAMS).mode_blocking_conditions() == 0


def test_a_step_that_is_turned_off_never_comes() -> None:
    assert FailsafeStep(2.0, HOLD, only_if="FS_CRASH_CHECK").delay(Params({"FS_CRASH_CHECK": 0})) == math.inf
    assert FailsafeStep(2.0, HOLD, only_if="FS_CRASH_CHECK", value=2).delay(Params({"FS_CRASH_CHECK": 1})) == math.inf
    assert FailsafeStep(2.0, HOLD, only_if="FS_CRASH_CHECK", value=1).delay(Params({"FS_CRASH_CHECK": 1})) == 2.0
    assert FailsafeStep("FS_TIMEOUT", HOLD).delay(PARAMS) == 1.5


def test_the_earliest_begin_of_a_lasting_condition_counts() -> None:
    failsafes = Failsafes(PARAMS)
    assert actions(failsafes, {Failsafe.MANUAL_LOSS: 10.0}, 10.0) == [NEUTRAL]
    assert actions(failsafes, {Failsafe.MANUAL_LOSS: 11.0}, 11.5) == [HOLD]
    failsafes = Failsafes(PARAMS)
    assert actions(failsafes, {Failsafe.MANUAL_LOSS: 11.0}, 11.0) == [NEUTRAL]
    assert actions(failsafes, {Failsafe.MANUAL_LOSS: 10.0}, 11.5) == [HOLD]


def test_a_condition_that_ends_while_another_lasts_starts_again() -> None:
    failsafes = Failsafes(PARAMS)
    both = {Failsafe.MANUAL_LOSS: 0.0, Failsafe.BATTERY_LOW: 0.0}
    assert actions(failsafes, both, 0.0) == [NEUTRAL, LIMIT, HOLD]
    assert actions(failsafes, {Failsafe.BATTERY_LOW: 0.0}, 1.0) == []
    assert failsafes.active == Failsafe.BATTERY_LOW
    assert actions(failsafes, {**both, Failsafe.MANUAL_LOSS: 2.0}, 2.0) == [NEUTRAL]
    assert failsafes.active == Failsafe.BATTERY_LOW | Failsafe.MANUAL_LOSS


def test_before_its_first_step_a_condition_is_not_active() -> None:
    failsafes = Failsafes(PARAMS)
    failsafes.update({Failsafe.TILT: 0.0}, 0.4)
    assert failsafes.active == 0
    assert failsafes.next_step(0.4) is None
    failsafes.update({Failsafe.TILT: 0.0}, 0.5)
    assert failsafes.active == Failsafe.TILT


def test_loss_of_mode_or_arming_is_latched_until_acknowledged() -> None:
    failsafes = Failsafes(PARAMS)
    failsafes.update(MANUAL_LOSS, 0.0)
    assert not failsafes.latched
    failsafes.update(MANUAL_LOSS, 1.5)
    assert failsafes.latched == Failsafe.MANUAL_LOSS
    failsafes.update({Failsafe.GCS_LOSS: 5.0}, 5.0)
    assert failsafes.latched == Failsafe.MANUAL_LOSS | Failsafe.GCS_LOSS
    failsafes.update({}, 6.0)
    assert failsafes.latched == Failsafe.MANUAL_LOSS | Failsafe.GCS_LOSS
    failsafes.acknowledge()
    assert not failsafes.latched


def test_returning_home_is_latched_also_as_one_of_several_steps() -> None:
    failsafes = Failsafes(Params({"FENCE_ACTION": 1}))
    assert actions(failsafes, {Failsafe.FENCE: 0.0}, 0.0) == [WARN, RTL]
    assert failsafes.latched == Failsafe.FENCE


def test_what_lasts_is_the_worst_up_to_neutral() -> None:
    failsafes = Failsafes(PARAMS)
    assert failsafes.lasting_action(0.0) is WARN
    failsafes.update({Failsafe.FENCE: 0.0}, 0.0)
    assert failsafes.lasting_action(0.0) is WARN
    failsafes.update({Failsafe.BATTERY_LOW: 0.0}, 0.0)
    assert failsafes.lasting_action(0.0) is LIMIT
    failsafes.update({Failsafe.MANUAL_LOSS: 0.0, Failsafe.BATTERY_LOW: 0.0}, 40.0)
    assert failsafes.lasting_action(40.0) is NEUTRAL
    failsafes.update({Failsafe.GCS_LOSS: 0.0}, 70.0)
    assert failsafes.lasting_action(70.0) is WARN
    failsafes.update({}, 71.0)
    assert failsafes.lasting_action(71.0) is WARN


@pytest.mark.parametrize("setting", [1, 2])
def test_the_way_home_is_no_lasting_action(setting: float) -> None:
    """It would hold the vehicle for as long as it is beyond the fence."""
    failsafes = Failsafes(Params({"FENCE_ACTION": setting}))
    failsafes.update({Failsafe.FENCE: 0.0}, 0.0)
    assert failsafes.lasting_action(0.0) is WARN


def test_of_several_steps_the_worst_lasts_and_hold_is_the_next(monkeypatch: pytest.MonkeyPatch) -> None:
    steps = (FailsafeStep(0, NEUTRAL), FailsafeStep(0, LIMIT), FailsafeStep(1, NEUTRAL), FailsafeStep(5, HOLD))
    monkeypatch.setitem(RULES, Failsafe.TILT, replace(RULES[Failsafe.TILT], steps=steps))
    failsafes = Failsafes(PARAMS)
    failsafes.update({Failsafe.TILT: 0.0}, 0.0)
    assert failsafes.lasting_action(0.0) is NEUTRAL
    step = failsafes.next_step(0.0)
    assert step is not None
    assert (step.delay, step.action) == (5.0, HOLD)


def test_the_next_step_is_the_next_hold_or_disarm() -> None:
    failsafes = Failsafes(PARAMS)
    assert failsafes.next_step(0.0) is None
    failsafes.update({Failsafe.MANUAL_LOSS: 10.0}, 10.0)
    step = failsafes.next_step(10.5)
    assert step is not None
    assert (step.delay, step.action) == (1.0, HOLD)
    failsafes.update({Failsafe.MANUAL_LOSS: 10.0}, 11.5)
    step = failsafes.next_step(11.5)
    assert step is not None
    assert (step.delay, step.action) == (28.5, DISARM)
    failsafes.update({Failsafe.MANUAL_LOSS: 10.0, Failsafe.BATTERY_CRITICAL: 12.0}, 12.0)
    step = failsafes.next_step(12.0)
    assert step is not None
    assert (step.delay, step.action) == (10.0, DISARM)


def test_steps_that_are_disabled_or_past_are_not_next() -> None:
    failsafes = Failsafes(Params({"FS_PI_ACT": 1}))
    failsafes.update({Failsafe.OVERHEAT: 0.0}, 1.0)
    assert failsafes.next_step(1.0) is None
    failsafes.update({Failsafe.GCS_LOSS: 0.0}, 60.0)
    assert failsafes.next_step(60.0) is None


class TestCheck:
    """check: the conditions of a moment, with the begins of before."""

    def check(self, rig: Rig, motion: MotionInputs, now: float, *, armed: bool = True) -> list[FailsafeAction]:
        safety = rig.safety
        inputs = FailsafeInputs(
            rig.params, rig.control, safety.battery, safety.computer, motion, manual=True, mission_running=False,
            latched=Failsafe(0), armed_at=START,
        )  # fmt: skip
        return [step.action for step in safety.failsafes.check(inputs, now, armed=armed)]

    def test_a_condition_is_timed_from_the_first_time_it_holds(self) -> None:
        rig = Rig(FS_GCS_ENABLE=0)
        tilted = MOTIONS[Failsafe.TILT]
        assert self.check(rig, tilted, START) == []
        assert self.check(rig, tilted, START + 0.49) == []
        assert self.check(rig, tilted, START + 0.5) == [DISARM]

    def test_the_earliest_begin_counts(self) -> None:
        rig = Rig(FS_GCS_ENABLE=0)
        assert self.check(rig, STANDING._replace(setpoint_expires=START - 1.0), START) == [NEUTRAL]
        assert self.check(rig, STANDING._replace(setpoint_expires=START - 3.5), START + 0.5) == [HOLD]
        rig = Rig(FS_GCS_ENABLE=0)
        assert self.check(rig, STANDING._replace(setpoint_expires=START - 3.5), START) == [NEUTRAL]
        assert self.check(rig, STANDING._replace(setpoint_expires=START - 1.0), START + 0.5) == [HOLD]

    def test_what_is_over_starts_again(self) -> None:
        rig = Rig(FS_GCS_ENABLE=0)
        tilted = MOTIONS[Failsafe.TILT]
        assert self.check(rig, tilted, START) == []
        assert self.check(rig, STANDING, START + 0.4) == []
        assert self.check(rig, tilted, START + 0.6) == []
        assert self.check(rig, tilted, START + 1.0) == []
        assert self.check(rig, tilted, START + 1.1) == [DISARM]

    def test_disarmed_no_step_is_reached_and_nothing_is_active(self) -> None:
        rig = Rig(FS_GCS_ENABLE=0)
        assert self.check(rig, MOTIONS[Failsafe.FENCE], START) == [WARN, HOLD]
        assert rig.safety.failsafes.active == Failsafe.FENCE
        assert self.check(rig, MOTIONS[Failsafe.FENCE], START + 1.0, armed=False) == []
        assert not rig.safety.failsafes.active

    @pytest.mark.parametrize("cause", [Failsafe.TILT, Failsafe.BLOCKED, Failsafe.POSITION, Failsafe.FENCE])
    def test_hazards_are_timed_while_disarmed(self, cause: Failsafe) -> None:
        rig = Rig(FS_GCS_ENABLE=0)
        assert self.check(rig, MOTIONS[cause], START, armed=False) == []
        expected = {
            Failsafe.TILT: [DISARM],
            Failsafe.BLOCKED: [HOLD],
            Failsafe.POSITION: [NEUTRAL, HOLD],
            Failsafe.FENCE: [WARN, HOLD],
        }[cause]
        assert self.check(rig, MOTIONS[cause], START + 2.0) == expected

    def test_the_others_are_not(self) -> None:
        assert {cause for cause, rule in RULES.items() if rule.timed_while_disarmed} == {
            Failsafe.TILT, Failsafe.BLOCKED, Failsafe.POSITION, Failsafe.FENCE
        }  # fmt: skip
        rig = Rig(FS_GCS_TIMEOUT=5)
        rig.control.take(conversation(255), START)
        assert self.check(rig, STANDING, START + 5.1, armed=False) == []
        rig.control.take(conversation(255), START + 60.0)
        assert self.check(rig, STANDING, START + 60.0) == []
        assert self.check(rig, STANDING, START + 65.1) == [HOLD]
