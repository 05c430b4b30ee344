"""The estimated position and motion, the result of vehicle/navigation/estimator.py."""

from __future__ import annotations

import math
from typing import NamedTuple

from vehicle.navigation.geo import Origin, Point


class Estimate(NamedTuple):
    """The estimate of a cycle; None if unknown. SI units, rad, yaw clockwise from north."""

    yaw: float | None = None
    yaw_rate: float | None = None
    speed: float | None = None
    """m/s forward, negative backward."""
    sideways: float = 0.0
    """m/s to the right, for drives that can move sideways."""
    place: Point = Point(0.0, 0.0)
    moving_place: bool = False
    """`place` follows the rover: by wheels and heading since the start, or by GPS."""
    origin: Origin | None = None
    """Global position of 0/0; None before the first 3D fix."""
    accuracy: float = math.inf
    """m; accuracy of the global position."""
    resets: int = 0
    """Number of jumps of `place`: a new origin, or a GPS position far off that proved to be right."""
    good: bool = False
    """The position is good enough to drive by: a recent fix, a heading, and sufficient accuracy."""

    @property
    def velocity(self) -> Point:
        """m/s north and east; 0 if the speed or the heading is unknown."""
        yaw = self.yaw or 0.0
        return Point(0.0, 0.0).offset(yaw, self.speed or 0.0).offset(yaw + math.pi / 2, self.sideways)

    @property
    def ground_speed(self) -> float:
        """m/s in any direction; 0 if unknown."""
        return math.hypot(self.speed or 0.0, self.sideways)

    @property
    def lat_lon(self) -> tuple[float, float] | None:
        """Latitude and longitude in degrees."""
        return None if self.origin is None else self.origin.to_global(self.place)
