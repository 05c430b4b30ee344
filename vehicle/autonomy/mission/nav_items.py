"""What a mission's NAV items do, one small task each; which one comes next is executor.py's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point, wrap_angle
from vehicle.navigation.guidance import Leg, PathFollower, has_arrived
from vehicle.navigation.speed_control import STATIONARY, DesiredMotion


class NavTask(Protocol):
    """One item under way."""

    @property
    def goal(self) -> Point | None:
        """Where it ends."""

    def step(self, guide: PathFollower, estimate: Estimate, speed: float, now: float) -> DesiredMotion | None:
        """What it wants now; None when it is done."""


@dataclass(slots=True)
class NavWaypoint:
    """Along a leg, and stay at its end for a while."""

    leg: Leg
    radius: float
    end_speed: float = 0.0
    stay: float = 0.0
    _there: float | None = None

    @property
    def goal(self) -> Point | None:
        """Its end."""
        return self.leg.end

    def step(self, guide: PathFollower, estimate: Estimate, speed: float, now: float) -> DesiredMotion | None:
        """Drive, then stand."""
        if self._there is None and has_arrived(self.leg, estimate.place, self.radius):
            self._there = now
        if self._there is None:
            return guide.follow_leg(self.leg, estimate, speed, self.end_speed)
        return STATIONARY if now - self._there < self.stay else None


@dataclass(slots=True)
class NavLoiterTurns:
    """Around a point so many times; clockwise with a positive radius. First out to the circle."""

    centre: Point
    radius: float
    turns: float
    _turned: float = 0.0
    _bearing: float | None = None

    @property
    def goal(self) -> Point | None:
        """Its middle."""
        return self.centre

    def step(self, guide: PathFollower, estimate: Estimate, speed: float, now: float) -> DesiredMotion | None:
        """Around; the angle counts once it is near the circle."""
        bearing = self.centre.bearing(estimate.place)
        if abs(self.centre.distance(estimate.place) - abs(self.radius)) < max(0.5, abs(self.radius) / 2):
            if self._bearing is not None:
                self._turned += wrap_angle(bearing - self._bearing) * math.copysign(1.0, self.radius)
            self._bearing = bearing
        if self._turned >= self.turns * math.tau:
            return None
        return guide.orbit(self.centre, self.radius, estimate, speed)


@dataclass(slots=True)
class NavDelay:
    """Stand for a while."""

    seconds: float
    goal: Point | None = None
    _began: float | None = None

    def step(self, guide: PathFollower, estimate: Estimate, speed: float, now: float) -> DesiredMotion | None:
        """Nothing."""
        self._began = now if self._began is None else self._began
        return STATIONARY if now - self._began < self.seconds else None


@dataclass(slots=True)
class ConditionYaw:
    """Turn on the spot to a heading."""

    heading: float
    goal: Point | None = None

    def step(self, guide: PathFollower, estimate: Estimate, speed: float, now: float) -> DesiredMotion | None:
        """Turn."""
        motion = guide.pivot(self.heading, estimate)
        return None if motion == STATIONARY else motion
