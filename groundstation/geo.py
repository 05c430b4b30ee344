"""Places on earth, and metres around one of them. Points are (north, east) in m.

The ground around a place is drawn as a plane. The error is 0.1 % at 10 km, more than a small rover drives.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import msgspec

Point = tuple[float, float]

METRES_PER_DEGREE = 111_319.5
"""Of latitude, m (WGS 84 at the equator; the error over a driving area is below what can be drawn)."""

MAX_LATITUDE, MAX_LONGITUDE = 90.0, 180.0
"""Degrees."""

FIX_2D = 2
"""GPS_FIX_TYPE from which a position counts."""

LEAST_SHRINK = 1e-6
"""Of the length of a degree of longitude: at the poles it has none, and nothing is divided by 0."""


class Place(NamedTuple):
    """A place on earth, degrees (WGS 84)."""

    latitude: float
    longitude: float


class Separation(NamedTuple):
    """The straight way from one place to another."""

    distance: float
    """m"""
    bearing: float
    """Degrees clockwise from north, 0..360."""


class LocalFrame(msgspec.Struct, frozen=True):
    """Converts places to metres around `origin`, and back."""

    origin: Place

    def to_point(self, place: Place) -> Point:
        """Return a place in m; across 180 degrees the short way."""
        north = (place.latitude - self.origin.latitude) * METRES_PER_DEGREE
        return north, wrap_longitude(place.longitude - self.origin.longitude) * METRES_PER_DEGREE * self._shrink

    def to_place(self, point: Point) -> Place:
        """Return a point as a place; beyond a pole its latitude is not on earth (`keep_on_earth`)."""
        latitude = self.origin.latitude + point[0] / METRES_PER_DEGREE
        return Place(latitude, wrap_longitude(self.origin.longitude + point[1] / (METRES_PER_DEGREE * self._shrink)))

    @property
    def _shrink(self) -> float:
        return max(LEAST_SHRINK, math.cos(math.radians(self.origin.latitude)))


def find_separation(start: Place | None, end: Place | None) -> Separation | None:
    """Return the way between two places that are some km apart at most; None if one is not known."""
    if start is None or end is None:
        return None
    point = LocalFrame(start).to_point(end)
    return Separation(math.hypot(*point), bearing((0.0, 0.0), point))


def bearing(start: Point, end: Point) -> float:
    """Return the direction from one point to another, degrees clockwise from north, 0..360."""
    return math.degrees(math.atan2(end[1] - start[1], end[0] - start[0])) % 360.0


def is_on_earth(latitude: float, longitude: float) -> bool:
    """Return whether degrees are a place on earth; NaN is none."""
    return abs(latitude) <= MAX_LATITUDE and abs(longitude) <= MAX_LONGITUDE


def place_fault(latitude: float, longitude: float) -> str | None:
    """Return why degrees are not a place on earth, or None; NaN is none."""
    if not abs(latitude) <= MAX_LATITUDE:
        return f"latitude {latitude:.9g} is not in -90 to 90"
    if not abs(longitude) <= MAX_LONGITUDE:
        return f"longitude {longitude:.9g} is not in -180 to 180"
    return None


def keep_on_earth(place: Place) -> Place:
    """Return a place with its latitude between the poles."""
    return Place(max(-MAX_LATITUDE, min(MAX_LATITUDE, place.latitude)), place.longitude)


def wrap_longitude(degrees: float) -> float:
    """Return the same longitude, or difference of longitudes, as -180..180."""
    return (degrees + MAX_LONGITUDE) % 360.0 - MAX_LONGITUDE


def read_place(latitude: int, longitude: int) -> tuple[float, float] | None:
    """Return degrees of degrees x 1e7; None for what stands for an unknown position: 0, 0 and out of range."""
    north, east = latitude / 1e7, longitude / 1e7
    if (not latitude and not longitude) or not is_on_earth(north, east):
        return None
    return north, (east if east < MAX_LONGITUDE else -MAX_LONGITUDE)


def place_around(centre: Point, heading: float, seen: Iterable[tuple[float, float]]) -> tuple[Point, ...]:
    """Return points that are seen from a vehicle: each a bearing clockwise from its nose, rad, and a distance, m."""
    north, east = centre
    return tuple(
        (
            round(north + distance * math.cos(heading + bearing), 2),
            round(east + distance * math.sin(heading + bearing), 2),
        )
        for bearing, distance in seen
    )
