"""Arming checks: what each forbids, force, position and fence, and their report in SYS_STATUS."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from dialects import messages as m
from dialects.enums import Command, FenceItem, MissionResult, MissionType, Result, Sensor
from dialects.modes import Mode
from tests.rows import each_row
from tests.vehicle.bench import AHEAD, EVERYTHING, NEUTRAL, Bench, said
from tests.vehicle.field import Field
from tests.vehicle.missions import upload
from vehicle.navigation.estimator import GPS_LOST
from vehicle.navigation.geo import Point
from vehicle.params import Params
from vehicle.safety.arming import ArmingFacts, find_problems
from vehicle.safety.states import SafetyState

NO_GPS = replace(EVERYTHING, gps_fix=0, latitude=None, longitude=None)
FORCE = 21196


def with_gps(**params: float) -> Bench:
    bench = Bench(**params)
    bench.readings = EVERYTHING
    bench.wait(2.0)
    return bench


def healthy(bench: Bench, sensor: Sensor) -> bool:
    status = bench.newest(m.SysStatus)
    assert status.onboard_control_sensors_present & sensor
    return bool(status.onboard_control_sensors_health & sensor)


def test_a_mode_that_needs_a_position_forbids_arming_without_one() -> None:
    bench = with_gps()
    assert bench.set_mode(Mode.LOITER) is Result.ACCEPTED
    bench.readings = NO_GPS
    bench.wait(GPS_LOST + 1.0)
    assert bench.arm() is Result.FAILED
    assert said(bench, "PreArm: mode not available: position is not known")
    assert bench.command(Command.COMPONENT_ARM_DISARM, 1, FORCE) is Result.FAILED
    assert bench.set_mode(Mode.MANUAL) is Result.ACCEPTED
    assert bench.arm() is Result.ACCEPTED


def test_the_state_of_the_estimate_is_in_sys_status() -> None:
    bench = with_gps()
    assert healthy(bench, Sensor.AHRS)
    assert healthy(bench, Sensor.GPS)
    assert healthy(bench, Sensor.PREARM)
    assert bench.set_mode(Mode.LOITER) is Result.ACCEPTED
    bench.readings = NO_GPS
    bench.wait(GPS_LOST + 2.0)
    assert not healthy(bench, Sensor.AHRS)
    assert not healthy(bench, Sensor.GPS)
    assert not healthy(bench, Sensor.PREARM)
    assert healthy(bench, Sensor.GYRO)


@pytest.mark.parametrize("kind", [2, 6])
def test_an_enabled_fence_requires_a_position_for_arming(kind: int) -> None:
    bench = Bench(FENCE_ENABLE=1, FENCE_TYPE=kind)
    bench.wait(1.0)
    assert bench.arm() is Result.FAILED
    assert said(bench, "PreArm: the fence requires a position")
    assert bench.command(Command.COMPONENT_ARM_DISARM, 1, FORCE) is Result.FAILED
    bench.readings = EVERYTHING
    bench.wait(1.0)
    assert bench.arm() is Result.ACCEPTED, bench.texts


def test_a_fence_without_a_boundary_requires_no_position() -> None:
    bench = Bench(FENCE_ENABLE=1, FENCE_TYPE=4)
    bench.wait(1.0)
    assert bench.arm() is Result.ACCEPTED


def test_uploaded_areas_require_a_position_for_arming() -> None:
    field = Field(FENCE_ENABLE=1, FENCE_TYPE=4)
    circle = [(FenceItem.CIRCLE_INCLUSION, Point(0, 0), (20,))]
    assert upload(field, *circle, kind=MissionType.FENCE) == MissionResult.ACCEPTED
    field.blind = {"gps_fix": 0, "latitude": None, "longitude": None}
    field.wait(GPS_LOST + 1.0)
    assert field.arm() is Result.FAILED
    assert said(field, "PreArm: the fence requires a position")
    assert field.command(Command.DO_FENCE_ENABLE, 0) is Result.ACCEPTED
    assert field.arm() is Result.ACCEPTED


def test_losing_position_in_manual_reports_the_unenforced_fence() -> None:
    field = Field(FENCE_ENABLE=1, FENCE_TYPE=2)
    field.wait(6.0)
    assert field.arm() is Result.ACCEPTED
    field.texts.clear()
    field.wait(0.2, NEUTRAL)
    field.blind = {"gps_fix": 0, "latitude": None, "longitude": None}
    field.wait(GPS_LOST + 1.0, AHEAD)
    assert field.turning
    assert said(field, "Fence not enforced: position is not known")
    field.blind = {}
    field.wait(6.0, AHEAD)
    assert said(field, "Fence OK again")


READY = ArmingFacts(Params(), SafetyState.SAFE)


def test_nothing_is_wrong_with_a_vehicle_that_is_ready() -> None:
    assert find_problems(READY) == []


@each_row(
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
