"""Telemetry of one vehicle as standard messages of ROS, in its units and frames (REP 103, REP 105).

Values are dictionaries with the names of the fields; what is not known is NaN, or marked as the message says.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from dialects import messages as m
from dialects.axes import axis_map, parse_axes
from dialects.enums import Autopilot, OperatorFlag, VehicleType
from groundstation.geo import FIX_2D, read_place
from groundstation.ros.frames import Quaternion, Vector, attitude_to_enu, frd_to_flu, into_body, ned_to_enu

Values = dict[str, Any]
FRESH = 500_000
"""us for which a measurement belongs to those after it."""
MILLI_G = 9.80665e-3
"""m/s2."""
NAN = math.nan
NO_FIX = -1
FIXES = {4: 1, 5: 2, 6: 2, 8: 1}
"""GPS_FIX_TYPE -> NavSatStatus.status: DGPS and PPP are augmented by satellites, RTK from the ground; others 0."""
SERVICE_GPS = 1
DIAGONAL_KNOWN = 2
CHARGING, CHARGE_STATE_CHARGING, DISCHARGING = 1, 7, 2
TECHNOLOGIES = {1: 3, 2: 4, 3: 2, 4: 1}
"""MAV_BATTERY_TYPE -> BatteryState.power_supply_technology."""
ODOMETRY = "nav_msgs/msg/Odometry"
BASE, ODOM, GPS = "base_link", "odom", "gps"


class RosVehicle:
    """One vehicle. Attitude and acceleration are kept for messages that have them beside others.

    `prefix` stands before its frames: those of two vehicles differ.
    """

    def __init__(self, component: int, prefix: str = "") -> None:
        self.component = component
        self.prefix = prefix
        self._base, self._odom, self._gps = (f"{prefix}{frame}" for frame in (BASE, ODOM, GPS))
        self.autopilot = int(Autopilot.INVALID)
        self._kind = int(VehicleType.GROUND_ROVER)
        self._drive_type: int | None = None
        self._attitude: tuple[int, Quaternion, Vector] | None = None
        """Time, rotation, rates of the body."""
        self._acceleration: tuple[int, Vector, int] | None = None
        """Time, m/s2, and how good its source is."""

    def take(self, message: m.Message, microseconds: int) -> tuple[str, str, Values] | None:
        """Handle a message of the vehicle at a Unix time; return topic, type and values of the message of ROS it makes.

        The topic has no leading slash: "odom", "imu", "fix", "battery_state". The type is named as in ROS 2. Values are
        numbers, text, lists and dictionaries; `header` is a tuple of the time in us and the frame.
        """
        row = ROWS.get(type(message))
        return None if row is None else row(self, message, microseconds)

    def take_demand(self, message: m.ManualControl | m.RoverOperatorPresence) -> tuple[str, str, Values] | None:
        """Return the operator's demand as parts of full deflection: forward, left and up are positive."""
        if isinstance(message, m.RoverOperatorPresence) and not message.flags & OperatorFlag.AXES:
            return None
        axes = parse_axes(message, axis_map(self.autopilot, self._kind, self._drive_type))
        if axes is None:
            return None
        twist = _twist((axes.throttle, -axes.side + 0.0, axes.climb), (0.0, 0.0, -axes.steering + 0.0))
        return "cmd_vel", "geometry_msgs/msg/Twist", twist

    # ---- rows ----

    def _heartbeat(self, message: m.Heartbeat, now: int) -> None:
        self.autopilot, self._kind = message.autopilot, message.type

    def _drive_info(self, message: m.RoverDriveInfo, now: int) -> None:
        self._drive_type = message.drive_type

    def _accelerate(self, now: int, vector: Vector, rank: int) -> None:
        """Keep an acceleration, unless a better source is there."""
        before = self._acceleration
        if not all(map(math.isfinite, vector)):
            return
        if before is None or rank >= before[2] or now - before[0] > FRESH:
            self._acceleration = now, frd_to_flu(vector), rank

    def _highres_imu(self, message: m.HighresImu, now: int) -> None:
        self._accelerate(now, (message.xacc, message.yacc, message.zacc), 2)

    def _scaled_imu(self, message: m.ScaledImu, now: int) -> None:
        self._accelerate(now, _scaled(message), 1)

    def _raw_imu(self, message: m.RawImu, now: int) -> None:
        if self.autopilot == Autopilot.ARDUPILOT:  # in mG there, in units of the sensor elsewhere
            self._accelerate(now, _scaled(message), 0)

    def _imu(self, message: m.Attitude, now: int) -> tuple[str, str, Values]:
        rotation = attitude_to_enu(message.roll, message.pitch, message.yaw)
        rates = frd_to_flu((message.rollspeed, message.pitchspeed, message.yawspeed))
        self._attitude = now, rotation, rates
        known = self._acceleration is not None and 0 <= now - self._acceleration[0] <= FRESH
        acceleration = self._acceleration[1] if self._acceleration is not None and known else (0.0, 0.0, 0.0)
        return "imu", "sensor_msgs/msg/Imu", {
            "header": (now, self._base),
            "orientation": _quaternion(rotation),
            "orientation_covariance": [0.0] * 9,
            "angular_velocity": _vector(rates),
            "angular_velocity_covariance": [0.0] * 9,
            "linear_acceleration": _vector(acceleration),
            "linear_acceleration_covariance": [0.0 if known else -1.0] + [0.0] * 8,
        }  # fmt: skip

    def _fix(self, message: m.GpsRawInt, now: int) -> tuple[str, str, Values]:
        place = read_place(message.lat, message.lon) if message.fix_type >= FIX_2D else None
        latitude, longitude = place or (NAN, NAN)
        horizontal, vertical = (message.h_acc / 1000) ** 2, (message.v_acc / 1000) ** 2
        status = NO_FIX if place is None else FIXES.get(message.fix_type, 0)
        known = bool(message.h_acc and message.v_acc)
        return "fix", "sensor_msgs/msg/NavSatFix", {
            "header": (now, self._gps),
            "status": {"status": status, "service": SERVICE_GPS},
            "latitude": latitude,
            "longitude": longitude,
            "altitude": message.alt_ellipsoid / 1000 if place and message.alt_ellipsoid else NAN,
            "position_covariance": [horizontal, 0, 0, 0, horizontal, 0, 0, 0, vertical] if known else [0.0] * 9,
            "position_covariance_type": DIAGONAL_KNOWN if known else 0,
        }  # fmt: skip

    def _odometry(self, message: m.LocalPositionNed, now: int) -> tuple[str, str, Values] | None:
        if self._attitude is None or not 0 <= now - self._attitude[0] <= FRESH:
            return None  # without the attitude neither the pose nor the velocity of the body is known
        _, rotation, rates = self._attitude
        velocity = into_body(rotation, ned_to_enu((message.vx, message.vy, message.vz)))
        place = ned_to_enu((message.x, message.y, message.z))
        pose = {"position": _vector(place), "orientation": _quaternion(rotation)}
        return "odom", ODOMETRY, {
            "header": (now, self._odom),
            "child_frame_id": self._base,
            "pose": {"pose": pose, "covariance": [0.0] * 36},
            "twist": {"twist": _twist(velocity, rates), "covariance": [0.0] * 36},
        }  # fmt: skip

    def _battery(self, message: m.BatteryStatus, now: int) -> tuple[str, str, Values]:
        cells = [each / 1000 for each in message.voltages if each != m.UINT16_MAX]
        cells += [each / 1000 for each in message.voltages_ext if each]
        current = NAN if message.current_battery == -1 else -message.current_battery / 100 + 0.0
        charging = message.charge_state == CHARGE_STATE_CHARGING
        status = CHARGING if charging else DISCHARGING if current < 0 else 0
        topic = "battery_state" if not message.id else f"battery_state_{message.id}"
        return topic, "sensor_msgs/msg/BatteryState", {
            "header": (now, self._base),
            "voltage": sum(cells) if cells else NAN,
            "temperature": NAN if message.temperature == 32767 else message.temperature / 100,
            "current": current,
            "charge": NAN,
            "capacity": NAN,
            "design_capacity": NAN,
            "percentage": NAN if message.battery_remaining < 0 else message.battery_remaining / 100,
            "power_supply_status": status,
            "power_supply_health": 0,
            "power_supply_technology": TECHNOLOGIES.get(message.type, 0),
            "present": True,
            "cell_voltage": cells if len(cells) > 1 else [],
            "cell_temperature": [],
            "location": str(message.id),
            "serial_number": "",
        }  # fmt: skip


def transforms(odometry: Values) -> Values:
    """Return the TFMessage of an Odometry: viewers place the frames of a vehicle by it (REP 105)."""
    pose = odometry["pose"]["pose"]
    place = {"translation": pose["position"], "rotation": pose["orientation"]}
    frames = {"header": odometry["header"], "child_frame_id": odometry["child_frame_id"]}
    return {"transforms": [{**frames, "transform": place}]}


ROWS: Mapping[type[m.Message], Callable[[RosVehicle, Any, int], tuple[str, str, Values] | None]] = {
    m.Heartbeat: RosVehicle._heartbeat,
    m.RoverDriveInfo: RosVehicle._drive_info,
    m.HighresImu: RosVehicle._highres_imu,
    m.ScaledImu: RosVehicle._scaled_imu,
    m.RawImu: RosVehicle._raw_imu,
    m.Attitude: RosVehicle._imu,
    m.GpsRawInt: RosVehicle._fix,
    m.LocalPositionNed: RosVehicle._odometry,
    m.BatteryStatus: RosVehicle._battery,
}
"""Message of MAVLink -> what it makes."""


def _scaled(message: m.ScaledImu | m.RawImu) -> Vector:
    return message.xacc * MILLI_G, message.yacc * MILLI_G, message.zacc * MILLI_G


def _vector(vector: Sequence[float]) -> Values:
    return dict(zip("xyz", vector, strict=True))


def _quaternion(rotation: Quaternion) -> Values:
    return dict(zip("xyzw", rotation, strict=True))


def _twist(linear: Vector, angular: Vector) -> Values:
    return {"linear": _vector(linear), "angular": _vector(angular)}
