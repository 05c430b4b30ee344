"""Metres on a flat ground and degrees on the globe, and angles: geometry only, no state."""

from __future__ import annotations

import math
from typing import NamedTuple

EARTH_RADIUS = 6378137.0
"""m, WGS 84 at the equator; flat around the origin, good to centimetres over the kilometre that such a rover drives."""


class Point(NamedTuple):
    """m north and east of the origin."""

    north: float
    east: float

    def distance(self, other: Point) -> float:
        """m from here to there."""
        return math.hypot(other.north - self.north, other.east - self.east)

    def bearing(self, other: Point) -> float:
        """rad clockwise from north, of there from here."""
        return math.atan2(other.east - self.east, other.north - self.north)

    def offset(self, bearing: float, distance: float) -> Point:
        """The point `distance` m from here."""
        return Point(self.north + distance * math.cos(bearing), self.east + distance * math.sin(bearing))


class Home(NamedTuple):
    """Where RTL goes: the first place on the globe, or the one that somebody has set."""

    latitude: float
    longitude: float
    altitude: float
    north: float
    east: float


class Origin(NamedTuple):
    """The place on the globe that is 0/0 on the ground."""

    latitude: float
    longitude: float

    def to_local(self, latitude: float, longitude: float) -> Point:
        """Degrees as metres."""
        east = math.remainder(longitude - self.longitude, 360.0)
        return Point(
            math.radians(latitude - self.latitude) * EARTH_RADIUS,
            math.radians(east) * EARTH_RADIUS * math.cos(math.radians(self.latitude)),
        )

    def to_global(self, point: Point) -> tuple[float, float]:
        """Metres as latitude and longitude."""
        width = EARTH_RADIUS * max(1e-6, math.cos(math.radians(self.latitude)))
        return (
            self.latitude + math.degrees(point.north / EARTH_RADIUS),
            math.remainder(self.longitude + math.degrees(point.east / width), 360.0),
        )


def wrap_angle(angle: float) -> float:
    """The same direction as -pi..pi."""
    return math.remainder(angle, math.tau)
