"""Where the rover believes to be and how it moves: what vehicle/navigation/estimator.py makes of the sensors. Numbers only."""

from __future__ import annotations

import math
from typing import NamedTuple

from vehicle.navigation.geo import Origin, Point


class Estimate(NamedTuple):
    """What is believed now; None where nothing is known. SI, rad, yaw clockwise from north; built each cycle."""

    yaw: float | None = None
    yaw_rate: float | None = None
    speed: float | None = None
    """Along the nose, negative backwards."""
    sideways: float = 0.0
    """To the right, of drives that can."""
    place: Point = Point(0.0, 0.0)
    moving_place: bool = False
    """`place` follows the rover: by wheels and heading from the start, or by GPS."""
    origin: Origin | None = None
    """Where 0/0 is; None before the first 3D fix."""
    accuracy: float = math.inf
    """m; of the place on the globe."""
    resets: int = 0
    """How often `place` has jumped: another origin, or a GPS that was right though it was far off."""
    good: bool = False
    """The place is good enough to drive by: a fix lately, a heading, and accuracy."""

    @property
    def velocity(self) -> Point:
        """m/s north and east; 0 where the speed or heading is not known."""
        yaw = self.yaw or 0.0
        return Point(0.0, 0.0).offset(yaw, self.speed or 0.0).offset(yaw + math.pi / 2, self.sideways)

    @property
    def ground_speed(self) -> float:
        """m/s, whichever way; 0 where it is not known."""
        return math.hypot(self.speed or 0.0, self.sideways)

    @property
    def lat_lon(self) -> tuple[float, float] | None:
        """Latitude and longitude in degrees."""
        return None if self.origin is None else self.origin.to_global(self.place)
