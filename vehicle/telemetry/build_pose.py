"""Builds attitude, position and motion in the messages that MAVSDK, MAVROS and visual odometry use.

They repeat what build_motion.py builds and are sent on request only: QGroundControl ignores ATTITUDE once it has
received ATTITUDE_QUATERNION. None without the sensor.
"""

from __future__ import annotations

import math

from dialects import messages as m
from vehicle.telemetry.build_motion import above_home, above_origin
from vehicle.telemetry.scaling import to_float32
from vehicle.telemetry.view import TelemetryView

LOCAL_NED, BODY_FRD = 1, 12
"""MAV_FRAME"""
ESTIMATOR_AUTOPILOT = 8
"""MAV_ESTIMATOR_TYPE_AUTOPILOT"""
ZGYRO = 32
"""HIGHRES_IMU_UPDATED_ZGYRO: the only axis that a rover's gyro measures."""
UNKNOWN_COVARIANCE = [math.nan, *[0.0] * 20]
TERRAIN_UNKNOWN, CLEARANCE_UNKNOWN = -1001.0, -1.0


def quaternion(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """Return w, x, y, z of a rotation by yaw, then pitch, then roll, in rad."""
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(angle / 2), math.cos(angle / 2)) for angle in (roll, pitch, yaw))
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def attitude_quaternion(view: TelemetryView) -> m.Message | None:
    """Build ATTITUDE_QUATERNION."""
    if view.estimate.yaw is None:
        return None
    return m.AttitudeQuaternion(
        view.boot_ms, *_quaternion(view), rollspeed=0.0, pitchspeed=0.0, yawspeed=to_float32(view.estimate.yaw_rate)
    )


def highres_imu(view: TelemetryView) -> m.Message | None:
    """Build HIGHRES_IMU: the gyro; NaN for everything else."""
    rate = view.readings.yaw_rate
    if rate is None:
        return None
    unknown = math.nan
    return m.HighresImu(
        view.boot_us, xacc=unknown, yacc=unknown, zacc=unknown, xgyro=unknown, ygyro=unknown, zgyro=rate,
        xmag=unknown, ymag=unknown, zmag=unknown, abs_pressure=unknown, diff_pressure=unknown, pressure_alt=unknown,
        temperature=unknown, fields_updated=ZGYRO,
    )  # fmt: skip


def odometry(view: TelemetryView) -> m.Message | None:
    """Build ODOMETRY: the local position, and the velocity in the body frame."""
    estimate = view.estimate
    if not estimate.moving_place:
        return None
    return m.Odometry(
        view.boot_us, LOCAL_NED, BODY_FRD,
        x=estimate.place.north, y=estimate.place.east, z=-above_origin(view), q=list(_quaternion(view)),
        vx=to_float32(estimate.speed), vy=estimate.sideways, vz=0.0,
        rollspeed=0.0, pitchspeed=0.0, yawspeed=to_float32(estimate.yaw_rate),
        pose_covariance=UNKNOWN_COVARIANCE, velocity_covariance=UNKNOWN_COVARIANCE,
        reset_counter=estimate.resets % 256, estimator_type=ESTIMATOR_AUTOPILOT,
    )  # fmt: skip


def altitude(view: TelemetryView) -> m.Message | None:
    """Build ALTITUDE from GPS."""
    amsl = view.readings.altitude
    if amsl is None:
        return None
    local, above = above_origin(view), above_home(view)
    return m.Altitude(view.boot_us, amsl, amsl, local, above, TERRAIN_UNKNOWN, CLEARANCE_UNKNOWN)


def _quaternion(view: TelemetryView) -> tuple[float, float, float, float]:
    readings = view.readings
    return quaternion(to_float32(readings.roll), to_float32(readings.pitch), to_float32(view.estimate.yaw))
