"""Path following: speed and turn rate to drive along a line, around a circle or to a heading.

Pure pursuit: the rover steers for a point on its line a little ahead (LOOKAHEAD), so that an error decays without
overshoot. The rover slows down for what it cannot turn at speed, stops and pivots for sharp corners, and brakes to stop
at the end.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from dialects.enums import DriveType
from vehicle.drive.mixer import clamp
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point, wrap_angle
from vehicle.navigation.speed_control import STATIONARY, DesiredMotion
from vehicle.params import Params

LOOKAHEAD_TIME = 1.0
"""s ahead on the line; with ATC_STR_ANG_P 2 the error decays with a damping of 0.7 ..."""
LOOKAHEAD_MIN = 0.6
"""... and m at least, so that a slow rover does not oscillate."""
APPROACH_SPEED_MIN = 0.12
"""m/s; the slowest approach, above the resolution of an encoder."""
PIVOT_TOLERANCE = math.radians(5)
"""rad; a pivot ends this close to its heading."""
GRAVITY = 9.81
"""m/s/s"""
STOP_RADIUS = 0.15
"""m from a point to stop at: less than the length of the rover and the accuracy of the GPS."""


class Leg(NamedTuple):
    """A straight line to drive."""

    start: Point
    end: Point

    @property
    def bearing(self) -> float:
        """Bearing of the line, rad."""
        return self.start.bearing(self.end)

    def along_and_cross_track(self, place: Point) -> tuple[float, float]:
        """Return the m that remain along the line, and the m to the right of it."""
        bearing = self.bearing
        north, east = self.end.north - place.north, self.end.east - place.east
        along = north * math.cos(bearing) + east * math.sin(bearing)
        return along, north * math.sin(bearing) - east * math.cos(bearing)


class PathFollower:
    """Follows one path at a time; call `reset` before each new one."""

    def __init__(self, params: Params, kind: DriveType) -> None:
        self.reverse = False
        """Drive backward along the path."""
        self.leg: Leg | None = None
        """The line to follow; None without one."""
        self.course: float | None = None
        """rad; the course steered."""
        self._params = params
        self._pivots = kind is not DriveType.ACKERMANN
        self._pivoting = False

    def set_reverse(self, reverse: bool) -> None:
        """Drive paths backwards, or forwards."""
        self.reverse = reverse

    def reset(self) -> None:
        """Forget the path and a pivot in progress."""
        self._pivoting = False
        self.leg = self.course = None

    def follow_leg(self, leg: Leg, estimate: Estimate, speed: float, end_speed: float) -> DesiredMotion:
        """Follow a leg with up to `speed` m/s, and `end_speed` at its end."""
        self.leg = leg
        remaining, beside = leg.along_and_cross_track(estimate.place)
        ahead = max(LOOKAHEAD_MIN, LOOKAHEAD_TIME * abs(estimate.speed or 0.0))
        braking = math.sqrt(end_speed**2 + 2.0 * self._params["ATC_DECEL_MAX"] * max(0.0, remaining))
        course = leg.bearing + math.atan2(-beside, ahead)
        return self.steer_course(course, estimate, min(speed, max(APPROACH_SPEED_MIN, braking)))

    def orbit(self, centre: Point, radius: float, estimate: Estimate, speed: float) -> DesiredMotion:
        """Circle `centre` clockwise; counter-clockwise if the radius is negative."""
        side = math.copysign(1.0, radius)
        out = centre.distance(estimate.place) - abs(radius)
        ahead = max(LOOKAHEAD_MIN, LOOKAHEAD_TIME * abs(estimate.speed or 0.0))
        tangent = centre.bearing(estimate.place) + side * math.pi / 2
        inward = side * math.atan2(out, ahead)
        motion = self.steer_course(tangent + inward, estimate, min(speed, math.sqrt(self._lateral_max * abs(radius))))
        turning = side * motion.speed / max(abs(radius), LOOKAHEAD_MIN)  # the turn rate of the circle itself
        if self._pivoting:
            return motion
        return DesiredMotion(motion.speed, self.limit_turn_rate(motion.turn_rate + turning, motion.speed, estimate))

    def steer_course(self, course: float, estimate: Estimate, speed: float) -> DesiredMotion:
        """Steer a course with up to `speed` m/s, slower the more the nose points away from it."""
        self.course = course
        nose = (estimate.yaw or 0.0) + (math.pi if self.reverse else 0.0)
        error = wrap_angle(course - nose)
        if self._must_pivot(error):
            rate = math.radians(self._params["WP_PIVOT_RATE"])
            return DesiredMotion(0.0, clamp(self._params["ATC_STR_ANG_P"] * error, rate))
        slowed = max(APPROACH_SPEED_MIN, speed * math.cos(error)) if abs(error) < math.pi / 2 else APPROACH_SPEED_MIN
        along = min(speed, slowed)
        motion = -along if self.reverse else along
        return DesiredMotion(motion, self.limit_turn_rate(self._params["ATC_STR_ANG_P"] * error, motion, estimate))

    def steer_heading(self, heading: float, estimate: Estimate, speed: float) -> DesiredMotion:
        """Steer a heading, forward or backward by the sign of the speed; pivot for sharp turns if possible."""
        self.course = heading
        error = wrap_angle(heading - (estimate.yaw or 0.0))
        if self._must_pivot(error):
            return self.pivot(heading, estimate)
        return DesiredMotion(speed, self.limit_turn_rate(self._params["ATC_STR_ANG_P"] * error, speed, estimate))

    def pivot(self, heading: float, estimate: Estimate) -> DesiredMotion:
        """Turn on the spot to a heading; STATIONARY once there, and if the wheels cannot pivot."""
        error = wrap_angle(heading - (estimate.yaw or 0.0))
        if not self._pivots or abs(error) < PIVOT_TOLERANCE:
            return STATIONARY
        rate = math.radians(self._params["WP_PIVOT_RATE"])
        return DesiredMotion(0.0, clamp(self._params["ATC_STR_ANG_P"] * error, rate))

    def corner_speed(self, angle: float, speed: float) -> float:
        """Return the m/s at which a corner of `angle` rad is driven."""
        if abs(angle) > self._pivot_angle:
            return 0.0 if self._pivots else APPROACH_SPEED_MIN
        return max(APPROACH_SPEED_MIN, speed * math.cos(angle))

    @property
    def _pivot_angle(self) -> float:
        return math.radians(self._params["WP_PIVOT_ANGLE"])

    def _must_pivot(self, error: float) -> bool:
        self._pivoting = self._pivots and abs(error) > (PIVOT_TOLERANCE if self._pivoting else self._pivot_angle)
        return self._pivoting

    def limit_turn_rate(self, rate: float, speed: float, estimate: Estimate) -> float:
        """Limit a turn rate to ATC_STR_RAT_MAX and to what ATC_TURN_MAX_G allows at this speed."""
        fastest = max(abs(speed), abs(estimate.speed or 0.0))
        largest = math.radians(self._params["ATC_STR_RAT_MAX"])
        return clamp(rate, min(largest, self._lateral_max / fastest) if fastest else largest)

    @property
    def _lateral_max(self) -> float:
        """m/s/s; the largest lateral acceleration."""
        return self._params["ATC_TURN_MAX_G"] * GRAVITY


def has_arrived(leg: Leg, place: Point, radius: float) -> bool:
    """Return True within `radius` m of the end, or past it."""
    return leg.end.distance(place) <= radius or leg.along_and_cross_track(place)[0] <= 0.0
