"""What libraries ask for beside the usual streams: the same truth in other messages, and only when asked."""

from __future__ import annotations

import math
from typing import Any

import pytest
from msgspec.structs import replace

from dialects import messages as m
from dialects.enums import Command, Result, Sensor
from tests.vehicle.bench import EVERYTHING, Bench
from vehicle.readings import Readings
from vehicle.telemetry.build_pose import ZGYRO, quaternion

KINDS: tuple[Any, ...] = (m.AttitudeQuaternion, m.HighresImu, m.Odometry, m.Altitude)


def asked(readings: Readings) -> Bench:
    """A rover with these sensors that was asked for all of them at 5 Hz."""
    bench = Bench()
    bench.readings = readings
    bench.heartbeat()
    bench.wait(1.0)
    for kind in KINDS:
        assert bench.command(Command.SET_MESSAGE_INTERVAL, kind.id, 200_000) is Result.ACCEPTED
    bench.wait(2.0)
    return bench


def test_they_come_only_when_asked_for() -> None:
    bench = Bench()
    bench.readings = EVERYTHING
    bench.heartbeat()
    bench.wait(5.0)
    assert bench.all(m.Attitude)
    assert not any(bench.all(kind) for kind in KINDS)
    bench = asked(EVERYTHING)
    assert all(len(bench.all(kind)) >= 9 for kind in KINDS)


def test_without_sensors_there_is_nothing_to_tell() -> None:
    bench = asked(Readings())
    assert not any(bench.all(kind) for kind in KINDS)


def test_they_agree_with_the_usual_streams() -> None:
    bench = asked(EVERYTHING)
    usual, local = bench.newest(m.Attitude), bench.newest(m.LocalPositionNed)
    turned = bench.newest(m.AttitudeQuaternion)
    wanted = quaternion(usual.roll, usual.pitch, usual.yaw)
    assert (turned.q1, turned.q2, turned.q3, turned.q4) == pytest.approx(wanted, abs=1e-3)
    path = bench.newest(m.Odometry)
    assert (path.x, path.y) == pytest.approx((local.x, local.y), abs=0.3)
    assert path.vx == pytest.approx(math.hypot(local.vx, local.vy), abs=0.05)
    assert path.q == pytest.approx(wanted, abs=1e-3)
    assert math.isnan(path.pose_covariance[0])
    height = bench.newest(m.Altitude)
    assert (height.altitude_amsl, height.altitude_relative) == (500.0, 0.0)
    assert (height.altitude_terrain < -1000, height.bottom_clearance < 0) == (True, True)  # not known


def test_the_gyro_is_all_that_an_imu_message_holds() -> None:
    imu = asked(replace(EVERYTHING, yaw_rate=0.25)).newest(m.HighresImu)
    assert (imu.zgyro, imu.fields_updated) == (0.25, ZGYRO)
    assert all(math.isnan(value) for value in (imu.xacc, imu.ygyro, imu.zmag, imu.abs_pressure, imu.temperature))


@pytest.mark.parametrize(
    ("angles", "wanted"),
    [
        ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)),
        ((0.0, 0.0, math.pi / 2), (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))),
        ((math.pi / 2, 0.0, 0.0), (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)),
        ((0.0, math.pi / 2, 0.0), (math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0)),
        ((math.pi / 2, 0.0, math.pi / 2), (0.5, 0.5, 0.5, 0.5)),
    ],
)
def test_quaternions(angles: tuple[float, float, float], wanted: tuple[float, ...]) -> None:
    assert quaternion(*angles) == pytest.approx(wanted)


def test_who_knows_level_has_an_accelerometer() -> None:
    assert asked(EVERYTHING).newest(m.SysStatus).onboard_control_sensors_health & Sensor.ACCELEROMETER
    level = asked(replace(EVERYTHING, roll=None, pitch=None)).newest(m.SysStatus)
    assert not level.onboard_control_sensors_present & Sensor.ACCELEROMETER
