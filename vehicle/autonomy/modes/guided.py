"""GUIDED: drives for the newest setpoint. A velocity counts for GUIDED_TIMEOUT, a place until another one comes."""

from __future__ import annotations

import math

from vehicle.autonomy.setpoints import Course, Place, Target
from vehicle.drive.mixer import clamp
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point
from vehicle.navigation.guidance import STOPPED_SHORT, Guide, Leg, arrived
from vehicle.navigation.speed_control import STAND, Motion
from vehicle.params import Params


class Guided:
    """The setpoint in force and what it makes of an estimate."""

    def __init__(self, params: Params, guide: Guide) -> None:
        self.target: Target | None = None
        self._params = params
        self._guide = guide
        self._at = -math.inf
        self._leg: Leg | None = None

    @property
    def goal(self) -> Point | None:
        """Where it goes, if it goes to a place."""
        return self.target.point if isinstance(self.target, Place) else None

    def take(self, target: Target, estimate: Estimate, now: float) -> None:
        """A new setpoint. The same place again goes on as it is."""
        self._at = now
        if target == self.target:
            return
        self.target = target
        self._leg = Leg(estimate.place, target.point) if isinstance(target, Place) else None
        self._guide.begin()

    def unready(self, estimate: Estimate) -> str | None:
        """Velocities need no sensor at all; a place is refused when it comes."""
        return None

    def begin(self, estimate: Estimate, now: float) -> None:
        """Chosen anew, armed or stopped: what was asked before is past."""
        self.target = self._leg = None

    def lost_since(self) -> float | None:
        """When a velocity began to be too old, or will. None where nothing can get old."""
        return self._at + self._params["GUIDED_TIMEOUT"] if isinstance(self.target, Course) else None

    def step(self, estimate: Estimate, speed: float, now: float) -> Motion | None:
        """None without a setpoint that counts."""
        target = self.target
        if isinstance(target, Place):
            return self._go(target, estimate, speed)
        lost = self.lost_since()
        if target is None or lost is None or now > lost:
            return None
        largest = self._params["SPEED_MAX"]
        return self._hold(target, clamp(target.speed, largest), estimate)

    def _hold(self, course: Course, speed: float, estimate: Estimate) -> Motion:
        if course.heading is not None:
            return self._guide.steer(course.heading, estimate, speed)
        return Motion(speed, self._guide.limited(course.turn_rate or 0.0, speed, estimate))

    def _go(self, place: Place, estimate: Estimate, speed: float) -> Motion:
        if self._leg is None or arrived(self._leg, estimate.place, STOPPED_SHORT):
            self._leg = None
            return STAND
        wanted = speed if place.speed is None else min(place.speed, self._params["SPEED_MAX"])
        return self._guide.follow(self._leg, estimate, wanted, 0.0)
