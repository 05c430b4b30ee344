"""Parameters that contradict each other forbid arming, by force as well."""

from __future__ import annotations

import pytest

from dialects.enums import Command, Result
from tests.vehicle.bench import Bench, said

FORCE = 21196


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
