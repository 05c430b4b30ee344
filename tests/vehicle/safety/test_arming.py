"""Pre-arm checks of position and fence, and their report in SYS_STATUS."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from dialects import messages as m
from dialects.enums import Command, FenceItem, MissionResult, MissionType, Result, Sensor
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, EVERYTHING, NEUTRAL, Bench, said
from tests.vehicle.field import Field
from tests.vehicle.missions import upload
from vehicle.navigation.estimator import GPS_LOST
from vehicle.navigation.geo import Point

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
