"""The NAV items of a mission, one task each; vehicle/autonomy/mission/executor.py runs them in order."""

from __future__ import annotations

import math
from typing import Protocol

import msgspec

from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point, wrap_angle
from vehicle.navigation.guidance import Leg, PathFollower, has_arrived
from vehicle.navigation.speed_control import STATIONARY, DesiredMotion


class NavTask(Protocol):
    """A NAV item in progress."""

    @property
    def goal(self) -> Point | None:
        """The place where the item ends, or None."""

    def step(self, guide: PathFollower, estimate: Estimate, speed: float, now: float) -> DesiredMotion | None:
        """Return the motion of this cycle; None when the item is done."""


class NavWaypoint(msgspec.Struct):
    """NAV_WAYPOINT and NAV_LOITER_TIME: follow a leg, and stay at its end for `stay` s."""

    leg: Leg
    radius: float
    end_speed: float = 0.0
    stay: float = 0.0
    _there: float | None = None

    @property
    def goal(self) -> Point | None:
        """The end of the leg."""
        return self.leg.end

    def step(self, guide: PathFollower, estimate: Estimate, speed: float, now: float) -> DesiredMotion | None:
        """Follow the leg, then stand until the time is over."""
        if self._there is None and has_arrived(self.leg, estimate.place, self.radius):
            self._there = now
        if self._there is None:
            return guide.follow_leg(self.leg, estimate, speed, self.end_speed)
        return STATIONARY if now - self._there < self.stay else None


class NavLoiterTurns(msgspec.Struct):
    """NAV_LOITER_TURNS: circle a point `turns` times; clockwise with a positive radius."""

    centre: Point
    radius: float
    turns: float
    _turned: float = 0.0
    _bearing: float | None = None

    @property
    def goal(self) -> Point | None:
        """The centre of the circle."""
        return self.centre

    def step(self, guide: PathFollower, estimate: Estimate, speed: float, now: float) -> DesiredMotion | None:
        """Drive out to the circle and follow it; only the angle near the circle counts."""
        bearing = self.centre.bearing(estimate.place)
        if abs(self.centre.distance(estimate.place) - abs(self.radius)) < max(0.5, abs(self.radius) / 2):
            if self._bearing is not None:
                self._turned += wrap_angle(bearing - self._bearing) * math.copysign(1.0, self.radius)
            self._bearing = bearing
        if self._turned >= self.turns * math.tau:
            return None
        return guide.orbit(self.centre, self.radius, estimate, speed)


class NavDelay(msgspec.Struct):
    """NAV_DELAY: stand for `seconds`."""

    seconds: float
    goal: Point | None = None
    _began: float | None = None

    def step(self, guide: PathFollower, estimate: Estimate, speed: float, now: float) -> DesiredMotion | None:
        """Stand until the time is over."""
        self._began = now if self._began is None else self._began
        return STATIONARY if now - self._began < self.seconds else None


class ConditionYaw(msgspec.Struct):
    """CONDITION_YAW: turn on the spot to a heading, rad."""

    heading: float
    goal: Point | None = None

    def step(self, guide: PathFollower, estimate: Estimate, speed: float, now: float) -> DesiredMotion | None:
        """Turn; done within PIVOT_TOLERANCE, and at once if the wheels cannot pivot."""
        motion = guide.pivot(self.heading, estimate)
        return None if motion == STATIONARY else motion
