"""GUIDED: follows the newest setpoint.

A velocity is valid for GUIDED_TIMEOUT, a position until the next setpoint.
"""

from __future__ import annotations

import math

from vehicle.autonomy.setpoints import PositionTarget, Target, VelocityTarget
from vehicle.drive.mixer import clamp
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point
from vehicle.navigation.guidance import STOP_RADIUS, Leg, PathFollower, has_arrived
from vehicle.navigation.speed_control import STATIONARY, DesiredMotion
from vehicle.params import Params


class GuidedMode:
    """The setpoint in use, and the motion that follows from it."""

    def __init__(self, params: Params, guide: PathFollower) -> None:
        self.target: Target | None = None
        self._params = params
        self._guide = guide
        self._set_at = -math.inf
        self._leg: Leg | None = None

    @property
    def goal(self) -> Point | None:
        """The place of a position setpoint."""
        return self.target.point if isinstance(self.target, PositionTarget) else None

    def set_target(self, target: Target, estimate: Estimate, now: float) -> None:
        """Use a new setpoint. A repeated position setpoint changes nothing."""
        self._set_at = now
        if target == self.target:
            return
        self.target = target
        self._leg = Leg(estimate.place, target.point) if isinstance(target, PositionTarget) else None
        self._guide.reset()

    def unready(self, estimate: Estimate) -> str | None:
        """Return None: velocities need no sensor, and a position setpoint is checked on arrival."""
        return None

    def begin(self, estimate: Estimate, now: float) -> None:
        """Forget the setpoint: it was requested before the mode began."""
        self.target = self._leg = None

    def expires_at(self) -> float | None:
        """Return when the velocity setpoint expired or will expire; None without one."""
        return self._set_at + self._params["GUIDED_TIMEOUT"] if isinstance(self.target, VelocityTarget) else None

    def step(self, estimate: Estimate, speed: float, now: float) -> DesiredMotion | None:
        """Return the motion toward the setpoint; None without a valid one."""
        target = self.target
        if isinstance(target, PositionTarget):
            return self._drive_to(target, estimate, speed)
        lost = self.expires_at()
        if target is None or lost is None or now > lost:
            return None
        largest = self._params["SPEED_MAX"]
        return self._follow(target, clamp(target.speed, largest), estimate)

    def _follow(self, velocity: VelocityTarget, speed: float, estimate: Estimate) -> DesiredMotion:
        if velocity.heading is not None:
            return self._guide.steer_heading(velocity.heading, estimate, speed)
        return DesiredMotion(speed, self._guide.limit_turn_rate(velocity.turn_rate or 0.0, speed, estimate))

    def _drive_to(self, position: PositionTarget, estimate: Estimate, speed: float) -> DesiredMotion:
        if self._leg is None or has_arrived(self._leg, estimate.place, STOP_RADIUS):
            self._leg = None
            return STATIONARY
        wanted = speed if position.speed is None else min(position.speed, self._params["SPEED_MAX"])
        return self._guide.follow_leg(self._leg, estimate, wanted, 0.0)
