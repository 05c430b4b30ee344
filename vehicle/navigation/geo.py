"""Local coordinates in metres, global coordinates in degrees, and angles: pure geometry."""

from __future__ import annotations

import math
from typing import NamedTuple

EARTH_RADIUS = 6378137.0
"""m, WGS 84 at the equator. A plane at the origin is accurate to centimetres over a kilometre."""


class Point(NamedTuple):
    """m north and east of the origin."""

    north: float
    east: float

    def distance(self, other: Point) -> float:
        """Return the distance in m."""
        return math.hypot(other.north - self.north, other.east - self.east)

    def bearing(self, other: Point) -> float:
        """Return the bearing of `other` from here, rad clockwise from north."""
        return math.atan2(other.east - self.east, other.north - self.north)

    def offset(self, bearing: float, distance: float) -> Point:
        """Return the point at `distance` m and `bearing` from here."""
        return Point(self.north + distance * math.cos(bearing), self.east + distance * math.sin(bearing))


class Home(NamedTuple):
    """The home position: the first known position, or the one set by a command."""

    latitude: float
    longitude: float
    altitude: float
    north: float
    east: float


class Origin(NamedTuple):
    """The global position of local 0/0."""

    latitude: float
    longitude: float

    def to_local(self, latitude: float, longitude: float) -> Point:
        """Convert degrees to metres."""
        east = math.remainder(longitude - self.longitude, 360.0)
        return Point(
            math.radians(latitude - self.latitude) * EARTH_RADIUS,
            math.radians(east) * EARTH_RADIUS * math.cos(math.radians(self.latitude)),
        )

    def to_global(self, point: Point) -> tuple[float, float]:
        """Convert metres to latitude and longitude."""
        width = EARTH_RADIUS * max(1e-6, math.cos(math.radians(self.latitude)))
        return (
            self.latitude + math.degrees(point.north / EARTH_RADIUS),
            math.remainder(self.longitude + math.degrees(point.east / width), 360.0),
        )


def wrap_angle(angle: float) -> float:
    """Return the same direction as -pi..pi."""
    return math.remainder(angle, math.tau)
