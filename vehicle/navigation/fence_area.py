"""An area of the fence, a circle or a polygon: distance to its edge, also along a course."""

from __future__ import annotations

import math
from collections.abc import Iterator

import msgspec

from vehicle.navigation.geo import Point


class FenceArea(msgspec.Struct, frozen=True):
    """A circle (one corner and a radius) or a polygon, to stay inside or outside of."""

    corners: tuple[Point, ...]
    radius: float
    inclusion: bool
    """The rover must stay inside."""

    def distance_to_edge(self, place: Point) -> float:
        """Return the m to the edge on the allowed side, negative on the other."""
        depth = self.radius - self.corners[0].distance(place) if self.radius else self._depth(place)
        return depth if self.inclusion else -depth

    def distance_ahead(self, place: Point, course: float) -> float:
        """Return the m to the edge straight ahead; infinite if the course misses the area."""
        if self.radius:
            return _to_circle(self.corners[0], self.radius, place, course)
        return min(_to_edge(start, end, place, course) for start, end in self._edges())

    def _edges(self) -> Iterator[tuple[Point, Point]]:
        return zip(self.corners, (*self.corners[1:], self.corners[0]), strict=True)

    def _depth(self, place: Point) -> float:
        """Return the m to the edge of the polygon, negative outside of it."""
        nearest, within = math.inf, False
        for start, end in self._edges():
            nearest = min(nearest, _to_segment(start, end, place))
            if (start.east > place.east) != (end.east > place.east):
                share = (place.east - start.east) / (end.east - start.east)
                within ^= place.north < start.north + share * (end.north - start.north)
        return nearest if within else -nearest


def _to_segment(start: Point, end: Point, place: Point) -> float:
    north, east = end.north - start.north, end.east - start.east
    length = north * north + east * east
    along = 0.0
    if length:
        along = ((place.north - start.north) * north + (place.east - start.east) * east) / length
    along = max(0.0, min(1.0, along))
    return place.distance(Point(start.north + along * north, start.east + along * east))


def _to_edge(start: Point, end: Point, place: Point, course: float) -> float:
    """Return where a ray meets a segment, m along the ray."""
    north, east = math.cos(course), math.sin(course)
    edge_north, edge_east = end.north - start.north, end.east - start.east
    across = north * edge_east - east * edge_north
    if not across:  # parallel: the ray meets the neighbouring edges
        return math.inf
    to_north, to_east = start.north - place.north, start.east - place.east
    ahead = (to_north * edge_east - to_east * edge_north) / across
    share = (to_north * east - to_east * north) / across
    return ahead if ahead >= 0.0 and 0.0 <= share <= 1.0 else math.inf


def _to_circle(centre: Point, radius: float, place: Point, course: float) -> float:
    """Return where a ray first meets a circle, m along the ray."""
    north, east = place.north - centre.north, place.east - centre.east
    away = north * math.cos(course) + east * math.sin(course)
    square = away * away - (north * north + east * east - radius * radius)
    if square < 0.0:
        return math.inf
    half = math.sqrt(square)
    return next((meeting for meeting in (-away - half, -away + half) if meeting >= 0.0), math.inf)
