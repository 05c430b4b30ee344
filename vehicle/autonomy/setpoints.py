"""Parses the setpoints of GUIDED: SET_POSITION_TARGET_LOCAL_NED, _GLOBAL_INT and SET_ATTITUDE_TARGET.

Velocity and yaw rate in the body frame (frame 8, mask 1479) equal the Twist of ROS, with turns clockwise as in NED. A
message with an invalid value in a field that is used is rejected as a whole, with a reason; altitude is never used.
Messages and masks: https://mavlink.io/en/messages/common.html#SET_POSITION_TARGET_LOCAL_NED
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import msgspec

from dialects import messages as m
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point, wrap_angle

LOCAL_NED, LOCAL_OFFSET_NED, BODY_NED, BODY_OFFSET_NED, BODY_FRD = 1, 7, 8, 9, 12
"""MAV_FRAME."""
BODY = (BODY_NED, BODY_OFFSET_NED, BODY_FRD)
LOCAL_FRAMES = (LOCAL_NED, LOCAL_OFFSET_NED, *BODY)
GLOBAL_FRAMES = (0, 3, 10, 5, 6, 11)
"""MAV_FRAME_GLOBAL, _RELATIVE_ALT, _TERRAIN_ALT and their deprecated _INT: they differ in the altitude only."""
POSITION, VELOCITY, ACCELERATION, YAW, YAW_RATE = 1 | 2, 8 | 16, 64 | 128 | 256, 1024, 2048
"""POSITION_TARGET_TYPEMASK: a bit that is set means "ignore". 512 only tells what an acceleration means, if one is
used: MAVProxy's `velocity` and many scripts set all bits but those of the velocity."""
ATTITUDE_YAW_RATE, ATTITUDE_THRUST, ATTITUDE_Q = 4, 64, 128
"""ATTITUDE_TARGET_TYPEMASK: "ignore" ..."""
THRUST_BODY = 32
"""... and "use thrust_body instead of thrust"."""
SETPOINT_MAX_AGE = 1.0
"""s; an older setpoint is ignored (bad input 47 in tests/test_bad_inputs.py)."""
REORDER_WINDOW = 1.0
"""s; a setpoint with an earlier time was overtaken, unless none came for this long: then the sender has restarted."""
CLOCK_DRIFT = 5e-4
"""s/s by which the clock of a sender may be slower than ours; a crystal deviates by a tenth of it."""
TIME_BOOT_WRAP = 2**32
"""ms; time_boot_ms wraps around here."""
QUATERNION_NORM_MIN = 0.5
"""Smallest norm of a quaternion, which should be 1: all zeros come from a sender that has set none."""
TARGET_DISTANCE_MAX = 1e5
"""m; a target farther away is rejected."""


class VelocityTarget(NamedTuple):
    """Drive at `speed`, turning at `turn_rate` or toward `heading`; valid for GUIDED_TIMEOUT.

    A negative speed is backward.
    """

    speed: float
    turn_rate: float | None = None
    heading: float | None = None


class PositionTarget(NamedTuple):
    """Drive to `point` and stop there. Valid until the next target."""

    point: Point
    speed: float | None = None
    """m/s; None for the cruise speed."""


Target = VelocityTarget | PositionTarget


class SetpointRejection(msgspec.Struct, frozen=True):
    """Why a setpoint was rejected."""

    reason: str


class SenderClock:
    """Estimates the age of a sender's setpoints on arrival, relative to the fastest of them.

    The clocks need not agree: a setpoint that waited in a radio or a socket is late compared with one that did not.
    TIMESYNC would not help, because time_boot_ms is another clock than the one that TIMESYNC compares.
    """

    def __init__(self) -> None:
        self._newest = 0
        self._at = -math.inf
        self._least = math.inf
        """Smallest difference of the two clocks seen, s."""
        self._first: int | None = None
        self._repeats = 0
        """Number of setpoints that repeat the first time: not a clock. -1: the time has changed, so it is a clock."""

    def age(self, boot_ms: int, now: float) -> float | None:
        """Return the age in s; None for a setpoint that was overtaken.

        The age is 0 if the sender has no clock: many scripts send 0, and ArduPilot's examples always 10. A clock that
        stops after it has run is treated differently.
        """
        if not boot_ms:
            return 0.0
        stopped = self._is_stopped(boot_ms)
        ahead = (boot_ms - self._newest + TIME_BOOT_WRAP // 2) % TIME_BOOT_WRAP - TIME_BOOT_WRAP // 2
        quiet = now - self._at
        if ahead < 0 and quiet < REORDER_WINDOW:
            return None
        if not math.isfinite(quiet) or ahead < 0:
            self._least, unwrapped = math.inf, boot_ms
        else:
            self._least, unwrapped = self._least + CLOCK_DRIFT * quiet, self._newest + ahead
        self._newest, self._at = unwrapped, now
        difference = now - unwrapped / 1000
        self._least = difference if stopped else min(self._least, difference)
        return difference - self._least

    def _is_stopped(self, boot_ms: int) -> bool:
        """Return True if the sender's clock has not advanced until now."""
        if self._first is None:
            self._first = boot_ms
        elif boot_ms == self._first and self._repeats >= 0:
            self._repeats += 1
        stopped = self._repeats > 0
        if boot_ms != self._first:
            self._repeats = -1
        return stopped


Setpoint = m.SetPositionTargetLocalNed | m.SetPositionTargetGlobalInt | m.SetAttitudeTarget
SetPosition = m.SetPositionTargetLocalNed | m.SetPositionTargetGlobalInt


def parse_position_target(message: SetPosition, estimate: Estimate) -> Target | SetpointRejection:
    """Return the target of SET_POSITION_TARGET_LOCAL_NED or _GLOBAL_INT, or why it is rejected."""
    mask = message.type_mask
    frames = LOCAL_FRAMES if isinstance(message, m.SetPositionTargetLocalNed) else GLOBAL_FRAMES
    if message.coordinate_frame not in frames:
        return SetpointRejection(f"frame {message.coordinate_frame} is not supported")
    if mask & ACCELERATION != ACCELERATION:
        return SetpointRejection("acceleration and force are not supported")
    if mask & POSITION not in (0, POSITION):
        return SetpointRejection("incomplete position")
    if mask & (POSITION | VELOCITY | YAW | YAW_RATE) == POSITION | VELOCITY | YAW | YAW_RATE:
        return SetpointRejection("all fields are ignored")
    wrong = _first_invalid(message, mask)
    if wrong:
        return SetpointRejection(f"{wrong} is not a number")
    return _position_target(message, estimate) if not mask & POSITION else _velocity_target(message, estimate)


def parse_attitude_target(message: m.SetAttitudeTarget, full_speed: float) -> Target | SetpointRejection:
    """Return the target of SET_ATTITUDE_TARGET, or why it is rejected.

    Thrust is the share of `full_speed`, as in ArduRover. Of thrust_body only the forward component is used.
    """
    mask = message.type_mask
    thrust = message.thrust_body[0] if mask & THRUST_BODY else message.thrust
    if mask & ATTITUDE_THRUST and not mask & THRUST_BODY:
        return SetpointRejection("thrust is missing")
    if mask & ATTITUDE_YAW_RATE and mask & ATTITUDE_Q:
        return SetpointRejection("neither attitude nor yaw rate")
    used = [thrust] + ([message.body_yaw_rate] if not mask & ATTITUDE_YAW_RATE else list(message.q))
    if not all(map(math.isfinite, used)):
        return SetpointRejection("a value is not a number")
    speed = max(-1.0, min(1.0, thrust)) * full_speed
    if not mask & ATTITUDE_YAW_RATE:
        return VelocityTarget(speed, turn_rate=message.body_yaw_rate)
    if math.hypot(*message.q) < QUATERNION_NORM_MIN:
        return SetpointRejection("invalid quaternion")
    return VelocityTarget(speed, heading=_yaw(message.q))


def _first_invalid(message: SetPosition, mask: int) -> str | None:
    used: list[tuple[str, float]] = []
    if not mask & POSITION and isinstance(message, m.SetPositionTargetLocalNed):
        used += [("x", message.x), ("y", message.y)]
    for bit, name in ((8, "vx"), (16, "vy"), (YAW, "yaw"), (YAW_RATE, "yaw_rate")):
        if not mask & bit:
            used.append((name, getattr(message, name)))
    return next((name for name, value in used if not math.isfinite(value)), None)


def _position_target(message: SetPosition, estimate: Estimate) -> Target | SetpointRejection:
    if not estimate.good:
        return SetpointRejection("position is not known")
    point = _global_point(message, estimate) if not isinstance(message, m.SetPositionTargetLocalNed) else (
        _local_point(message, estimate))  # fmt: skip
    if isinstance(point, SetpointRejection):
        return point
    if not estimate.place.distance(point) <= TARGET_DISTANCE_MAX:
        return SetpointRejection("too far away")
    velocity = (0.0 if message.type_mask & 8 else message.vx, 0.0 if message.type_mask & 16 else message.vy)
    return PositionTarget(point, math.hypot(*velocity) or None)


def _local_point(message: m.SetPositionTargetLocalNed, estimate: Estimate) -> Point:
    if message.coordinate_frame == LOCAL_NED:
        return Point(message.x, message.y)
    turn = (estimate.yaw or 0.0) if message.coordinate_frame in BODY else 0.0
    north, east = _rotated(message.x, message.y, turn)
    return Point(estimate.place.north + north, estimate.place.east + east)


def _global_point(message: m.SetPositionTargetGlobalInt, estimate: Estimate) -> Point | SetpointRejection:
    return global_to_local(message.lat_int, message.lon_int, estimate) or SetpointRejection("invalid position")


def global_to_local(latitude: float, longitude: float, estimate: Estimate) -> Point | None:
    """Convert degrees x 1e7; None for an invalid position: 0/0, INT32_MAX and beyond the poles."""
    degrees = latitude / 1e7, longitude / 1e7
    valid = abs(degrees[0]) <= 90.0 and abs(degrees[1]) <= 180.0 and (latitude, longitude) != (0, 0)
    return estimate.origin.to_local(*degrees) if valid and estimate.origin is not None else None


def _velocity_target(message: SetPosition, estimate: Estimate) -> Target | SetpointRejection:
    mask = message.type_mask
    body = message.coordinate_frame in BODY
    ahead, right = (0.0 if mask & 8 else message.vx), (0.0 if mask & 16 else message.vy)
    if not body and mask & VELOCITY != VELOCITY:
        if estimate.yaw is None:
            return SetpointRejection("heading is not known")
        if not mask & YAW_RATE:
            return VelocityTarget(_rotated(ahead, right, -estimate.yaw)[0], turn_rate=message.yaw_rate)
        if mask & YAW:
            speed = math.hypot(ahead, right)
            return (
                VelocityTarget(speed, heading=math.atan2(right, ahead)) if speed else VelocityTarget(0.0, turn_rate=0.0)
            )
    if not mask & YAW_RATE:
        return VelocityTarget(ahead, turn_rate=message.yaw_rate)
    return _heading_target(message, estimate, ahead, right, body)


def _heading_target(
    message: SetPosition, estimate: Estimate, ahead: float, right: float, body: bool
) -> Target | SetpointRejection:
    """Return a target by an explicit yaw, or by the direction of a velocity in the body frame."""
    yaw = estimate.yaw
    if not message.type_mask & YAW:
        if yaw is None:
            return SetpointRejection("heading is not known")
        requested = message.yaw + (yaw if body else 0.0)
        return VelocityTarget(ahead if body else _rotated(ahead, right, -yaw)[0], heading=wrap_angle(requested))
    if not right:
        return VelocityTarget(ahead, turn_rate=0.0)
    if yaw is None:
        return SetpointRejection("heading is not known")
    return VelocityTarget(math.hypot(ahead, right), heading=wrap_angle(yaw + math.atan2(right, ahead)))


def _rotated(x: float, y: float, angle: float) -> tuple[float, float]:
    return x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)


def _yaw(q: Sequence[float]) -> float:
    w, x, y, z = q
    return math.atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)
