"""GUIDED: drives for the newest setpoint. A velocity counts for GUIDED_TIMEOUT, a place until another one comes."""

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
    """The setpoint in force and what it makes of an estimate."""

    def __init__(self, params: Params, guide: PathFollower) -> None:
        self.target: Target | None = None
        self._params = params
        self._guide = guide
        self._at = -math.inf
        self._leg: Leg | None = None

    @property
    def goal(self) -> Point | None:
        """Where it goes, if it goes to a place."""
        return self.target.point if isinstance(self.target, PositionTarget) else None

    def set_target(self, target: Target, estimate: Estimate, now: float) -> None:
        """A new setpoint. The same place again goes on as it is."""
        self._at = now
        if target == self.target:
            return
        self.target = target
        self._leg = Leg(estimate.place, target.point) if isinstance(target, PositionTarget) else None
        self._guide.reset()

    def unready(self, estimate: Estimate) -> str | None:
        """Velocities need no sensor at all; a place is refused when it comes."""
        return None

    def begin(self, estimate: Estimate, now: float) -> None:
        """Chosen anew, armed or stopped: what was asked before is past."""
        self.target = self._leg = None

    def expires_at(self) -> float | None:
        """When a velocity began to be too old, or will. None where nothing can get old."""
        return self._at + self._params["GUIDED_TIMEOUT"] if isinstance(self.target, VelocityTarget) else None

    def step(self, estimate: Estimate, speed: float, now: float) -> DesiredMotion | None:
        """None without a setpoint that counts."""
        target = self.target
        if isinstance(target, PositionTarget):
            return self._go(target, estimate, speed)
        lost = self.expires_at()
        if target is None or lost is None or now > lost:
            return None
        largest = self._params["SPEED_MAX"]
        return self._hold(target, clamp(target.speed, largest), estimate)

    def _hold(self, course: VelocityTarget, speed: float, estimate: Estimate) -> DesiredMotion:
        if course.heading is not None:
            return self._guide.steer_heading(course.heading, estimate, speed)
        return DesiredMotion(speed, self._guide.limit_turn_rate(course.turn_rate or 0.0, speed, estimate))

    def _go(self, place: PositionTarget, estimate: Estimate, speed: float) -> DesiredMotion:
        if self._leg is None or has_arrived(self._leg, estimate.place, STOP_RADIUS):
            self._leg = None
            return STATIONARY
        wanted = speed if place.speed is None else min(place.speed, self._params["SPEED_MAX"])
        return self._guide.follow_leg(self._leg, estimate, wanted, 0.0)
