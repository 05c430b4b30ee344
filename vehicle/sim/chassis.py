"""Motion of the simulated rover: speed, turn rate and position from the throttles, for each drive type."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Protocol

import msgspec

from dialects.enums import DriveType

AT_REST = 1e-3
"""m/s; a slower wheel without throttle is at rest, as with friction; otherwise a stopped rover would creep forever."""


class ChassisDimensions(msgspec.Struct, frozen=True):
    """Dimensions of a rover. The defaults are those of a 40 cm kit with geared 12 V motors."""

    top_speed: float = 1.5
    """m/s at full throttle and nominal voltage: 230 rpm of a 12.5 cm wheel."""
    track_width: float = 0.35
    """m between left and right wheels."""
    wheelbase: float = 0.3
    """m between the axles; used for steered wheels only."""
    scrub: float = 2.0
    """Factor of the effective track width with skid steering, as wheels slide sideways (1.5 to 2 on hard floors)."""
    motor_lag: float = 0.15
    """s until a motor has reached 63 % of a change, from gearbox and mass. Shorter than the slew time of the rover
    (0.4 s), which dominates the response, as with a real rover."""
    steering_max: float = 0.5
    """rad at full steering (29 degrees, typical of a model car): turning radius 0.55 m."""
    steering_rate: float = 5.0
    """rad/s of a typical steering servo (0.2 s for 60 degrees)."""


class ChassisMotion(msgspec.Struct):
    """Position and motion of the rover in SI units; angles clockwise from north."""

    north: float = 0.0
    east: float = 0.0
    yaw: float = 0.0
    """0 to 2 pi."""
    speed: float = 0.0
    """Forward speed; negative is backward."""
    sideways: float = 0.0
    """Speed to the right; only wheels with rollers allow it."""
    yaw_rate: float = 0.0
    acceleration: float = 0.0
    """Forward acceleration."""
    sway: float = 0.0
    """Acceleration to the right, including that of a turn."""
    push: float = 0.0
    """m/s that a slope adds to the speed of wheels that turn, forward; standing ones are held by their gears."""
    wheel_speeds: tuple[float, ...] = (0.0, 0.0)
    """m/s of left and right side, of the driven axle, or of each of four wheels."""

    @property
    def velocity(self) -> tuple[float, float]:
        """Velocity north and east, m/s."""
        ahead, across = math.cos(self.yaw), math.sin(self.yaw)
        return self.speed * ahead - self.sideways * across, self.speed * across + self.sideways * ahead

    def on_slope(self, wanted: float) -> float:
        """Return the speed that a wheel reaches here where it would reach `wanted` on level ground."""
        return wanted + self.push if wanted else 0.0

    def advance(self, speed: float, yaw_rate: float, dt: float, sideways: float = 0.0) -> None:
        """Move for `dt` with the mean of old and new speed and turn rate."""
        along, right = (self.speed + speed) / 2 * dt, (self.sideways + sideways) / 2 * dt
        turn = (self.yaw_rate + yaw_rate) / 2 * dt
        middle = self.yaw + turn / 2
        self.north += along * math.cos(middle) - right * math.sin(middle)
        self.east += along * math.sin(middle) + right * math.cos(middle)
        self.yaw = (self.yaw + turn) % math.tau
        self.acceleration = (speed - self.speed) / dt
        self.sway = speed * yaw_rate + (sideways - self.sideways) / dt
        self.speed, self.sideways, self.yaw_rate = speed, sideways, yaw_rate


class Chassis(Protocol):
    """The motion of one drive type."""

    motion: ChassisMotion
    top_speed: float
    """m/s at full throttle and nominal voltage."""

    def step(self, throttles: Sequence[float], strength: float, dt: float) -> None:
        """Move for `dt` > 0 with these motor outputs; `strength` is the ratio of voltage to nominal voltage."""


class SkidChassis:
    """Two driven sides, like a tank; `throttles` are left and right."""

    def __init__(self, frame: ChassisDimensions | None = None) -> None:
        self._frame = frame or ChassisDimensions()
        self.top_speed = self._frame.top_speed
        self.motion = ChassisMotion()

    def step(self, throttles: Sequence[float], strength: float, dt: float) -> None:
        """Move: each side follows its throttle, and the difference turns the rover."""
        frame, motion = self._frame, self.motion
        top = frame.top_speed * strength
        left = _follow(motion.wheel_speeds[0], motion.on_slope(throttles[0] * top), frame.motor_lag, dt)
        right = _follow(motion.wheel_speeds[1], motion.on_slope(throttles[1] * top), frame.motor_lag, dt)
        motion.wheel_speeds = (left, right)
        motion.advance((left + right) / 2, (left - right) / (frame.track_width * frame.scrub), dt)


class AckermannChassis:
    """A driven axle and steered front wheels, like a car; `throttles` are throttle and steering."""

    def __init__(self, frame: ChassisDimensions | None = None) -> None:
        self._frame = frame or ChassisDimensions()
        self.top_speed = self._frame.top_speed
        self.motion = ChassisMotion(wheel_speeds=(0.0,))
        self._angle = 0.0

    def step(self, throttles: Sequence[float], strength: float, dt: float) -> None:
        """Move: the axle follows the throttle, the steering servo its target at its own rate (bicycle model)."""
        frame, motion = self._frame, self.motion
        wanted = motion.on_slope(throttles[0] * frame.top_speed * strength)
        speed = _follow(motion.speed, wanted, frame.motor_lag, dt)
        reach = frame.steering_rate * dt
        self._angle += max(-reach, min(reach, throttles[1] * frame.steering_max - self._angle))
        motion.wheel_speeds = (speed,)
        motion.advance(speed, speed * math.tan(self._angle) / frame.wheelbase, dt)


CORNERS: tuple[tuple[int, int, int], ...] = ((1, -1, 1), (1, 1, -1), (-1, -1, -1), (-1, 1, 1))
"""Front left, front right, rear left, rear right: each with its position forward and right of the centre, and the side
to which it pushes when turning forward. Seen from above, the rollers of mecanum wheels form an X, and so do the axles
of omni wheels."""


class FourWheelChassis:
    """Four driven corners that push forward and sideways equally: mecanum wheels, or omni wheels at 45 degrees."""

    def __init__(self, frame: ChassisDimensions | None = None) -> None:
        self._frame = frame or ChassisDimensions()
        self.top_speed = self._frame.top_speed
        self.motion = ChassisMotion(wheel_speeds=(0.0,) * len(CORNERS))

    def step(self, throttles: Sequence[float], strength: float, dt: float) -> None:
        """Each wheel follows its throttle; the rover makes the motion that fits all of them best, the rest is slip.

        A wheel's m/s are those of the rover driving straight ahead, as an encoder's are that was calibrated so.
        """
        frame, motion = self._frame, self.motion
        top = frame.top_speed * strength
        pairs = zip(motion.wheel_speeds, throttles, strict=True)
        wheels = tuple(_follow(old, motion.on_slope(throttle * top), frame.motor_lag, dt) for old, throttle in pairs)
        corners = list(zip(wheels, CORNERS, strict=True))
        speed = sum(wheels) / len(wheels)
        sideways = sum(wheel * push for wheel, (_, _, push) in corners) / len(wheels)
        round_ = sum(-wheel * right for wheel, (_, right, _) in corners) / len(wheels)
        motion.wheel_speeds = wheels
        motion.advance(speed, round_ / ((frame.track_width + frame.wheelbase) / 2), dt, sideways)


CHASSIS: dict[DriveType, Callable[[ChassisDimensions], Chassis]] = {
    DriveType.SKID: SkidChassis,
    DriveType.ACKERMANN: AckermannChassis,
    DriveType.OMNI: FourWheelChassis,
    DriveType.MECANUM: FourWheelChassis,
}
"""DRIVE_TYPE -> how the simulated rover moves."""


def _follow(speed: float, wanted: float, lag: float, dt: float) -> float:
    """Return the next value of a first-order lag, exact for any dt."""
    speed = wanted + (speed - wanted) * math.exp(-dt / lag)
    return 0.0 if wanted == 0.0 and abs(speed) < AT_REST else speed
