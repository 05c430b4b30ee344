"""Speed and turn-rate controllers: throttle and steering, closed over wheels and gyro.

Each controller is feed-forward plus a correction by the sensor (ArduRover's ATC_ parameters). Without the sensor the
feed-forward drives alone: CRUISE_THROTTLE gives CRUISE_SPEED, and full steering 1 / ATC_STR_RAT_FF rad/s.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from dialects.enums import DriveType
from vehicle.drive.mixer import clamp
from vehicle.navigation.estimate import Estimate
from vehicle.params import Params

INTEGRAL_MAX = 0.5
"""Largest share of full throttle or steering of an integral: a rover that is held must not wind up."""
STEERING_SPEED_MIN = 0.2
"""m/s; steered wheels turn nothing at rest, so that their angle is computed for this speed at least."""


LONGEST_STEP = 0.1
"""s; the longest cycle of the controllers, equal to the one that zeroes the motors."""


class DesiredMotion(NamedTuple):
    """Desired speed in m/s forward and turn rate in rad/s clockwise."""

    speed: float
    turn_rate: float


STATIONARY = DesiredMotion(0.0, 0.0)


class SpeedTurnController:
    """The two controllers. Call `step` in each cycle while driving, `reset` otherwise."""

    def __init__(self, params: Params, kind: DriveType) -> None:
        self._params = params
        self._kind = kind
        self._speed = 0.0
        self._speed_trim = self._turn_trim = 0.0
        self._at = 0.0

    def reset(self) -> None:
        """Reset ramps and integrals."""
        self._speed = self._speed_trim = self._turn_trim = 0.0

    def step(self, wanted: DesiredMotion, estimate: Estimate, now: float) -> tuple[float, float]:
        """Return throttle and steering, -1..1, for the desired motion."""
        dt = self._elapsed(now)
        throttle = self._throttle(wanted.speed, estimate.speed, dt)
        if wanted == STATIONARY:
            self._turn_trim = 0.0
            return throttle, 0.0
        return throttle, self._steering(wanted.turn_rate, estimate, dt)

    def steering_for_rate(self, rate: float, estimate: Estimate, now: float) -> float:
        """Return the steering for a turn rate, if the throttle comes from elsewhere."""
        return self._steering(rate, estimate, self._elapsed(now))

    def _elapsed(self, now: float) -> float:
        dt, self._at = max(0.0, min(LONGEST_STEP, now - self._at)), now
        return dt

    def _steering(self, rate: float, estimate: Estimate, dt: float) -> float:
        params, measured = self._params, estimate.yaw_rate
        speed = self._speed if estimate.speed is None else estimate.speed
        steering = self._feed_forward(rate, speed)
        if measured is not None and not self._is_at_rest(speed):
            error = rate - measured
            flip = -1.0 if self._kind is DriveType.ACKERMANN and speed < 0.0 else 1.0
            if abs(steering) < 1.0:
                self._turn_trim = clamp(self._turn_trim + params["ATC_STR_RAT_I"] * error * dt, INTEGRAL_MAX)
            steering += flip * (params["ATC_STR_RAT_P"] * error + self._turn_trim)
        return clamp(steering, 1.0)

    def _feed_forward(self, rate: float, speed: float) -> float:
        params = self._params
        if self._kind is not DriveType.ACKERMANN:
            return clamp(params["ATC_STR_RAT_FF"] * rate, 1.0)
        reckoned = math.copysign(max(abs(speed), STEERING_SPEED_MIN), speed)
        full = math.atan(params["WHEELBASE"] / params["TURN_RADIUS"])
        return clamp(math.atan(rate * params["WHEELBASE"] / reckoned) / full, 1.0)

    def _is_at_rest(self, speed: float) -> bool:
        return self._kind is DriveType.ACKERMANN and abs(speed) < self._params["ATC_STOP_SPEED"]

    def _throttle(self, wanted: float, measured: float | None, dt: float) -> float:
        params = self._params
        self._speed = self._ramped(wanted, dt)
        if self._speed == 0.0 and abs(measured or 0.0) < params["ATC_STOP_SPEED"]:
            self._speed_trim = 0.0
            return 0.0
        throttle = self._speed / params["CRUISE_SPEED"] * params["CRUISE_THROTTLE"] / 100
        if measured is not None:
            error = self._speed - measured
            if abs(throttle) < 1.0:
                self._speed_trim = clamp(self._speed_trim + params["ATC_SPEED_I"] * error * dt, INTEGRAL_MAX)
            throttle += params["ATC_SPEED_P"] * error + self._speed_trim
        return clamp(throttle, 1.0)

    def _ramped(self, wanted: float, dt: float) -> float:
        slower = abs(wanted) < abs(self._speed) or wanted * self._speed < 0.0
        step = self._params["ATC_DECEL_MAX" if slower else "ATC_ACCEL_MAX"] * dt
        return self._speed + clamp(wanted - self._speed, step)
