"""The outline of the rover, obstacles around it, and how fast a motion of the wheels closes on them.

x is m ahead of the centre, y m to the right, turn rates are clockwise: the frame of the rover.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from dialects.enums import DriveType
from vehicle.drive.mixer import FOUR_WHEELS
from vehicle.params import Params


class Motion(NamedTuple):
    """m/s ahead and to the right, and rad/s."""

    ahead: float
    right: float
    turn: float


ObstaclePoint = tuple[float, float]
"""x and y of a point of an obstacle. A plain tuple: hundreds of them are made in each cycle."""


def carry(places: Sequence[ObstaclePoint], motion: Motion, dt: float) -> list[ObstaclePoint]:
    """Return where places are in the frame of the rover after the rover has moved for `dt` s."""
    ahead, right = motion.ahead * dt, motion.right * dt
    sine, cosine = math.sin(motion.turn * dt), math.cos(motion.turn * dt)
    first, second = ahead * cosine + right * sine, right * cosine - ahead * sine
    return [(x * cosine + y * sine - first, y * cosine - x * sine - second) for x, y in places]


class OutlineGap(NamedTuple):
    """The way from the outline to an obstacle.

    The speed at which a motion closes it is that of its nearest point of the outline: x times the speed ahead, y times
    that to the right, and `lever` times the turn rate.
    """

    clearance: float
    """m; 0 within the outline."""
    x: float
    """Direction of the obstacle from there, of length 1."""
    y: float
    lever: float
    """m: what a turn of 1 rad/s adds to the closing speed."""


class Outline:
    """A rectangle around the centre of the wheels (BODY_LENGTH, BODY_WIDTH)."""

    def __init__(self, params: Params) -> None:
        self.ahead: float = params["BODY_LENGTH"] / 2
        self.aside: float = params["BODY_WIDTH"] / 2

    @property
    def radius(self) -> float:
        """Distance of the corners from the centre, m."""
        return math.hypot(self.ahead, self.aside)

    def radius_at(self, bearing: float) -> float:
        """Return the m from the centre to the outline in a direction."""
        cosine, sine = abs(math.cos(bearing)), abs(math.sin(bearing))
        return min(self.ahead / cosine if cosine > 1e-9 else math.inf, self.aside / sine if sine > 1e-9 else math.inf)

    def gap(self, place: ObstaclePoint) -> OutlineGap:
        """Return the way from the outline to an obstacle; within it, from the centre outwards."""
        place_x, place_y = place
        x = max(-self.ahead, min(self.ahead, place_x))
        y = max(-self.aside, min(self.aside, place_y))
        away_x, away_y = place_x - x, place_y - y
        clearance = math.hypot(away_x, away_y)
        if clearance < 1e-9:
            away_x, away_y = place_x / self.ahead, place_y / self.aside
            if abs(away_x) >= abs(away_y):
                away_x, away_y = math.copysign(1.0, away_x), 0.0
            else:
                away_x, away_y = 0.0, math.copysign(1.0, away_y)
            return OutlineGap(0.0, away_x, away_y, place_x * away_y - place_y * away_x)
        away_x, away_y = away_x / clearance, away_y / clearance
        return OutlineGap(clearance, away_x, away_y, x * away_y - y * away_x)


LEAST_FEED_FORWARD = 0.01
"""ATC_STR_RAT_FF below which the turn rate is not known from it: 0 is its end."""


def turn_rate_of(params: Params) -> float:
    """Return the rad/s of full steering."""
    return 1.0 / max(LEAST_FEED_FORWARD, params["ATC_STR_RAT_FF"])


class WheelMotion:
    """How the rover moves by the values of its wheels."""

    def __init__(self, params: Params, kind: DriveType) -> None:
        self._kind = kind
        self._top: float = params["SPEED_MAX"]
        self._turn = turn_rate_of(params)
        self._curve = math.atan(params["WHEELBASE"] / params["TURN_RADIUS"])
        self._wheelbase: float = params["WHEELBASE"]

    def of(self, wheels: Sequence[float]) -> Motion:
        """Return the motion of these wheel values, -1..1."""
        if self._kind is DriveType.ACKERMANN:
            ahead = wheels[0] * self._top
            return Motion(ahead, 0.0, ahead * math.tan(self._curve * wheels[1]) / self._wheelbase)
        if len(wheels) == len(FOUR_WHEELS):
            ahead, turn, right = (
                sum(wheel * factors[axis] for wheel, factors in zip(wheels, FOUR_WHEELS, strict=True)) / 4
                for axis in range(3)
            )
            return Motion(ahead * self._top, right * self._top, turn * self._turn)
        left, right = wheels
        return Motion((left + right) / 2 * self._top, 0.0, (left - right) / 2 * self._turn)
