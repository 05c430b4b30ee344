"""The streams of MAVSDK's telemetry plugin that a rover has, and what their values must be."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

UNASKED: dict[str, Callable[[Any], bool]] = {
    "position": lambda value: abs(value.latitude_deg) > 1,
    "home": lambda value: abs(value.latitude_deg) > 1,
    "armed": lambda value: not value,
    "in_air": lambda value: not value,
    "landed_state": lambda value: value.name == "ON_GROUND",
    "vtol_state": lambda value: value.name == "UNDEFINED",
    "flight_mode": lambda value: True,  # MAVSDK reads the number as PX4's if it does not know the autopilot
    "attitude_euler": lambda value: -180 <= value.yaw_deg <= 180,
    "attitude_angular_velocity_body": lambda value: math.isfinite(value.yaw_rad_s),
    "velocity_ned": lambda value: abs(value.north_m_s) < 1,
    "position_velocity_ned": lambda value: abs(value.position.north_m) < 5,
    "heading": lambda value: 0 <= value.heading_deg <= 360,
    "fixedwing_metrics": lambda value: 0 <= value.groundspeed_m_s < 1,
    "gps_info": lambda value: value.num_satellites > 5 and value.fix_type.name == "FIX_3D",
    "raw_gps": lambda value: abs(value.latitude_deg) > 1 and 0 < value.hdop < 5,
    "battery": lambda value: value.voltage_v > 5 and 0 < value.remaining_percent <= 100,
    "rc_status": lambda value: not value.is_available,
    "unix_epoch_time": lambda value: value > 1.7e15,
    "health": lambda value: value.is_home_position_ok and value.is_global_position_ok and value.is_armable,
    "health_all_ok": lambda value: value,
}
"""Streams that start by themselves."""
ASKED: dict[str, Callable[[Any], bool]] = {
    "attitude_quaternion": lambda value: math.isclose(
        math.hypot(value.w, value.x, value.y, value.z), 1.0, abs_tol=1e-3
    ),
    "odometry": lambda value: True,
    "imu": lambda value: math.isfinite(value.angular_velocity_frd.down_rad_s),
    "altitude": lambda value: math.isfinite(value.altitude_amsl_m),
}
"""Streams that start when their rate is set."""
