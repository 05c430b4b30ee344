"""The setpoints of GUIDED as messages say them: SET_POSITION_TARGET_* and SET_ATTITUDE_TARGET become targets.

Velocity and yaw rate in the body frame (frame 8, mask 1479) is the Twist of ROS, its turn clockwise as in NED.
A message with anything wrong in a field that counts is refused as a whole, in words; altitude never counts for a rover.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from dialects import messages as m
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point, wrap_angle

LOCAL_NED, LOCAL_OFFSET_NED, BODY_NED, BODY_OFFSET_NED, BODY_FRD = 1, 7, 8, 9, 12
"""MAV_FRAME."""
BODY = (BODY_NED, BODY_OFFSET_NED, BODY_FRD)
LOCAL_FRAMES = (LOCAL_NED, LOCAL_OFFSET_NED, *BODY)
GLOBAL_FRAMES = (0, 3, 10, 5, 6, 11)
"""GLOBAL, _RELATIVE_ALT, _TERRAIN_ALT and their deprecated _INT: the altitude is all that differs."""
POSITION, VELOCITY, ACCELERATION, YAW, YAW_RATE = 1 | 2, 8 | 16, 64 | 128 | 256, 1024, 2048
"""POSITION_TARGET_TYPEMASK: a bit that is set says "ignore". 512 only says what an acceleration is, where one counts:
MAVProxy's `velocity` and many scripts set all bits but those of the velocity."""
ATTITUDE_YAW_RATE, ATTITUDE_THRUST, ATTITUDE_Q = 4, 64, 128
"""ATTITUDE_TARGET_TYPEMASK: "ignore" ..."""
THRUST_BODY = 32
"""... and "thrust_body counts, and not thrust"."""
SETPOINT_MAX_AGE = 1.0
"""s; an older setpoint is not driven by (bad input 47)."""
REORDER_WINDOW = 1.0
"""s; a setpoint whose sender's clock went back was overtaken, unless nothing came for so long: then the sender has
started anew."""
CLOCK_DRIFT = 5e-4
"""s/s by which a sender's clock may be slower than ours; a crystal's is a tenth of it."""
TIME_BOOT_WRAP = 2**32
"""ms; where time_boot_ms begins again."""
QUATERNION_NORM_MIN = 0.5
"""Length of a quaternion, which should be 1: all zeros are somebody who has filled in nothing."""
TARGET_DISTANCE_MAX = 1e5
"""m; a place beyond is no place for a rover."""


class VelocityTarget(NamedTuple):
    """Drive at `speed`, negative backwards, turning at `turn_rate` or toward `heading`. Counts for GUIDED_TIMEOUT."""

    speed: float
    turn_rate: float | None = None
    heading: float | None = None


class PositionTarget(NamedTuple):
    """Go there and stand. Counts until there is another target."""

    point: Point
    speed: float | None = None
    """m/s; None: the usual one."""


Target = VelocityTarget | PositionTarget


@dataclass(frozen=True, slots=True)
class SetpointRejection:
    """Why a setpoint is none."""

    reason: str


class SenderClock:
    """How old a sender's setpoints are when they arrive, against the fastest of them.

    No clocks have to agree: what waited in a radio or a socket is late against what did not. The two ways of TIMESYNC
    would know no more, because time_boot_ms is another clock than the one that it compares.
    """

    def __init__(self) -> None:
        self._newest = 0
        self._at = -math.inf
        self._least = math.inf
        """Least difference of the two clocks seen, s."""
        self._first: int | None = None
        self._stands = 0
        """Setpoints with the first time again: this is no clock. -1: another time was there, it is one."""

    def age(self, boot_ms: int, now: float) -> float | None:
        """s; None for one that was overtaken. 0 where the sender has no clock: many scripts send 0, and ArduPilot's
        examples always 10. A clock that stops is another matter."""
        if not boot_ms:
            return 0.0
        stood = self._is_stopped(boot_ms)
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
        self._least = difference if stood else min(self._least, difference)
        return difference - self._least

    def _is_stopped(self, boot_ms: int) -> bool:
        """Did it stand until now?"""
        if self._first is None:
            self._first = boot_ms
        elif boot_ms == self._first and self._stands >= 0:
            self._stands += 1
        stood = self._stands > 0
        if boot_ms != self._first:
            self._stands = -1
        return stood


Setpoint = m.SetPositionTargetLocalNed | m.SetPositionTargetGlobalInt | m.SetAttitudeTarget
SetPosition = m.SetPositionTargetLocalNed | m.SetPositionTargetGlobalInt


def parse_position_target(message: SetPosition, estimate: Estimate) -> Target | SetpointRejection:
    """The target of SET_POSITION_TARGET_LOCAL_NED or _GLOBAL_INT."""
    mask = message.type_mask
    frames = LOCAL_FRAMES if isinstance(message, m.SetPositionTargetLocalNed) else GLOBAL_FRAMES
    if message.coordinate_frame not in frames:
        return SetpointRejection(f"frame {message.coordinate_frame} is not offered")
    if mask & ACCELERATION != ACCELERATION:
        return SetpointRejection("acceleration and force are not offered")
    if mask & POSITION not in (0, POSITION):
        return SetpointRejection("half a position")
    if mask & (POSITION | VELOCITY | YAW | YAW_RATE) == POSITION | VELOCITY | YAW | YAW_RATE:
        return SetpointRejection("nothing is asked for")
    wrong = _no_numbers(message, mask)
    if wrong:
        return SetpointRejection(f"{wrong} is no number")
    return _position_target(message, estimate) if not mask & POSITION else _velocity_target(message, estimate)


def parse_attitude_target(message: m.SetAttitudeTarget, full_speed: float) -> Target | SetpointRejection:
    """The target of SET_ATTITUDE_TARGET: thrust is the share of `full_speed`, as in ArduRover.

    Thrust in the body's frame is the forward part of it: a rover has no other.
    """
    mask = message.type_mask
    thrust = message.thrust_body[0] if mask & THRUST_BODY else message.thrust
    if mask & ATTITUDE_THRUST and not mask & THRUST_BODY:
        return SetpointRejection("thrust is missing")
    if mask & ATTITUDE_YAW_RATE and mask & ATTITUDE_Q:
        return SetpointRejection("neither attitude nor yaw rate")
    used = [thrust] + ([message.body_yaw_rate] if not mask & ATTITUDE_YAW_RATE else list(message.q))
    if not all(map(math.isfinite, used)):
        return SetpointRejection("a value is no number")
    speed = max(-1.0, min(1.0, thrust)) * full_speed
    if not mask & ATTITUDE_YAW_RATE:
        return VelocityTarget(speed, turn_rate=message.body_yaw_rate)
    if math.hypot(*message.q) < QUATERNION_NORM_MIN:
        return SetpointRejection("its quaternion is none")
    return VelocityTarget(speed, heading=_yaw(message.q))


def _no_numbers(message: SetPosition, mask: int) -> str | None:
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
    return global_to_local(message.lat_int, message.lon_int, estimate) or SetpointRejection("no such place")


def global_to_local(latitude: float, longitude: float, estimate: Estimate) -> Point | None:
    """Degrees x 1e7 on our ground; None for what is no place: 0/0, INT32_MAX and beyond the poles."""
    degrees = latitude / 1e7, longitude / 1e7
    sane = abs(degrees[0]) <= 90.0 and abs(degrees[1]) <= 180.0 and (latitude, longitude) != (0, 0)
    return estimate.origin.to_local(*degrees) if sane and estimate.origin is not None else None


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
    """By an explicit yaw, or by the direction of a velocity in the body's frame."""
    yaw = estimate.yaw
    if not message.type_mask & YAW:
        if yaw is None:
            return SetpointRejection("heading is not known")
        asked = message.yaw + (yaw if body else 0.0)
        return VelocityTarget(ahead if body else _rotated(ahead, right, -yaw)[0], heading=wrap_angle(asked))
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
