"""The arming checks, one by one: what each forbids, and whether arming by force skips it."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from dialects.enums import Command, Result
from tests.vehicle.bench import Bench, said
from vehicle.params import Params
from vehicle.safety.arming import ArmingFacts, find_problems
from vehicle.safety.states import SafetyState

FORCE = 21196
READY = ArmingFacts(Params(), SafetyState.SAFE)


def test_nothing_is_wrong_with_a_vehicle_that_is_ready() -> None:
    assert find_problems(READY) == []


@pytest.mark.parametrize(
    ("wrong", "hard"),
    [
        ({"terminated": True}, True),
        ({"estop_reason": "pressed"}, True),
        ({"state": SafetyState.ESTOP}, True),
        ({"fault": "no answer"}, True),
        ({"state": SafetyState.BOOT}, True),
        ({"state": SafetyState.OFF}, True),
        ({"params": Params({"FS_TIMEOUT": 6.0, "FS_DISARM_T": 5.0})}, True),
        ({"mode": "position is not known"}, True),
        ({"fence": "there is none"}, True),
        ({"battery_low": True}, False),
        ({"battery_critical": True}, False),
        ({"battery_silent": True}, False),
        ({"computer": "too hot"}, False),
        ({"sticks_moving": True}, False),
    ],
)
def test_each_fact_forbids_arming_and_force_skips_soft_ones(wrong: dict[str, object], hard: bool) -> None:
    facts = replace(READY, **wrong)
    found = find_problems(facts)
    assert len(found) == 1
    assert all(word in found[0] for word in wrong.values() if isinstance(word, str))
    assert find_problems(facts, force=True) == (found if hard else [])


def test_damaged_settings_forbid_arming_also_by_force() -> None:
    params = Params()
    params.mark_damaged("checksum wrong")
    found = find_problems(replace(READY, params=params), force=True)
    assert len(found) == 1
    assert found[0].startswith("checksum wrong")


def test_the_pi_is_no_reason_where_its_failsafe_is_off() -> None:
    facts = replace(READY, params=Params({"FS_PI_ACT": 0}), computer="too hot")
    assert find_problems(facts) == []


def test_the_worst_of_several_is_named() -> None:
    def only(**wrong: object) -> str:
        (problem,) = find_problems(replace(READY, **wrong))
        return problem

    stopped = {"terminated": True, "estop_reason": "pressed", "state": SafetyState.ESTOP}
    assert only(**stopped) == only(terminated=True)
    assert only(estop_reason="pressed", state=SafetyState.ESTOP) == only(estop_reason="pressed")
    assert only(battery_silent=True, battery_critical=True) == only(battery_silent=True)
    assert only(battery_critical=True, battery_low=True) == only(battery_critical=True)
    assert len({only(battery_silent=True), only(battery_critical=True), only(battery_low=True)}) == 3


def test_problems_come_in_the_order_of_their_checks() -> None:
    wrong = replace(READY, terminated=True, fault="no answer", battery_low=True, sticks_moving=True)
    assert [len(find_problems(wrong)), len(find_problems(wrong, force=True))] == [4, 2]
    assert find_problems(wrong)[0] == find_problems(replace(READY, terminated=True))[0]


@pytest.mark.parametrize(
    ("params", "problem"),
    [
        ({"FS_TIMEOUT": 6.0, "FS_DISARM_T": 5.0}, "FS_DISARM_T is shorter than FS_TIMEOUT"),
        ({"BATT_LOW_VOLT": 10.0, "BATT_CRT_VOLT": 10.1}, "BATT_CRT_VOLT is above BATT_LOW_VOLT"),
    ],
)
@pytest.mark.parametrize("force", [0, FORCE])
def test_contradicting_parameters_forbid_arming(params: dict[str, float], problem: str, force: float) -> None:
    bench = Bench(**params)
    assert bench.command(Command.COMPONENT_ARM_DISARM, 1, force) is Result.FAILED
    bench.wait(0.1)
    assert said(bench, f"PreArm: {problem}")
    assert not bench.armed


@pytest.mark.parametrize(
    "params",
    [
        {"FS_TIMEOUT": 6.0, "FS_DISARM_T": 6.0},
        {"BATT_LOW_VOLT": 10.0, "BATT_CRT_VOLT": 10.0},
        {"BATT_LOW_VOLT": 0.0, "BATT_CRT_VOLT": 10.0},
    ],
)
def test_parameters_at_the_edge_allow_arming(params: dict[str, float]) -> None:
    assert Bench(**params).arm() is Result.ACCEPTED
