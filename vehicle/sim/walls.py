"""Walls of the simulation: what range sensors see of them, and whether the rover touches one. m north and east."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

from vehicle.navigation.geo import Point
from vehicle.readings import Cone, RangeReading
from vehicle.sim.chassis import ChassisMotion

Segment = tuple[Point, Point]

SCAN_PERIOD = 0.1
"""s between two scans, as of a small lidar."""
FAR = 8.0
"""m that the simulated sensor sees."""
SECTORS = 72
RANGE_NOISE = 0.02
"""m, standard deviation."""
DROPOUTS = 0.05
"""Share of directions that see nothing in a scan although there is something."""


class Walls:
    """Line segments that stop nobody: `clearance` is the ground truth."""

    def __init__(self, segments: Sequence[Segment]) -> None:
        self.segments = tuple(segments)

    def scan(self, place: Point, yaw: float, sectors: int = SECTORS) -> list[float]:
        """Return the m to the nearest wall in each sector, clockwise from the nose; infinite without one.

        Within a sector the nearest point of a wall lies on an edge of the sector, at an end of the wall, or where the
        wall is nearest of all.
        """
        found = [math.inf] * sectors
        step = math.tau / sectors
        edges = [yaw + (index + 0.5) * step for index in range(sectors)]
        for first, second in self.segments:
            start, end = (first.north - place.north, first.east - place.east), (
                second.north - place.north, second.east - place.east)  # fmt: skip
            for north, east in (start, end, _nearest(start, end)):
                sector = round((math.atan2(east, north) - yaw) / step) % sectors
                found[sector] = min(found[sector], math.hypot(north, east))
            for index, bearing in enumerate(edges):
                distance = _ray(start, end, bearing)
                if distance is not None:
                    after = (index + 1) % sectors
                    found[index], found[after] = min(found[index], distance), min(found[after], distance)
        return found

    def clearance(self, motion: ChassisMotion, length: float, width: float) -> float:
        """Return the m between a rectangle around the rover and the nearest wall; 0 in contact."""
        cosine, sine = math.cos(motion.yaw), math.sin(motion.yaw)
        nearest = math.inf
        for segment in self.segments:
            ends = []
            for point in segment:
                north, east = point.north - motion.north, point.east - motion.east
                ends.append((north * cosine + east * sine, east * cosine - north * sine))
            nearest = min(nearest, _gap(ends[0], ends[1], length / 2, width / 2))
        return nearest


class SimulatedLidar:
    """Looks around ten times a second, with noise and dropouts."""

    def __init__(self, walls: Walls, seed: int, *, sectors: int = SECTORS, noise: float = RANGE_NOISE,
                 dropouts: float = DROPOUTS, far: float = FAR) -> None:  # fmt: skip
        self._walls, self._sectors, self._far = walls, sectors, far
        self._noise, self._dropouts = noise, dropouts
        self._random = random.Random(seed)
        self._due = -math.inf
        self._newest: RangeReading | None = None

    def read(self, motion: ChassisMotion, now: float) -> RangeReading:
        """Return the newest scan."""
        if self._newest is None or now >= self._due:
            self._due = now + SCAN_PERIOD
            distances = self._walls.scan(Point(motion.north, motion.east), motion.yaw, self._sectors)
            step = math.tau / self._sectors
            cones = tuple(
                Cone(index * step, step / 2, self._measure(distance), self._far, central=True)
                for index, distance in enumerate(distances)
            )
            self._newest = RangeReading("lidar", cones, now)
        return self._newest

    def _measure(self, distance: float) -> float:
        if distance >= self._far or self._random.random() < self._dropouts:
            return self._far
        return max(0.0, min(self._far, distance + self._random.gauss(0.0, self._noise)))


class Surroundings:
    """Walls around one rover, and the sensor with which it sees them."""

    def __init__(self, walls: Walls, seed: int, *, length: float, width: float) -> None:
        self._walls, self._size = walls, (length, width)
        self._lidar = SimulatedLidar(walls, seed)

    def read(self, motion: ChassisMotion, now: float) -> RangeReading:
        """Return the newest scan of the sensor."""
        return self._lidar.read(motion, now)

    def clearance(self, motion: ChassisMotion) -> float:
        """Return the true m to the nearest wall; 0 in contact."""
        return self._walls.clearance(motion, *self._size)


def _nearest(start: tuple[float, float], end: tuple[float, float]) -> tuple[float, float]:
    """Return the point of a segment that is nearest to 0/0."""
    along = end[0] - start[0], end[1] - start[1]
    square = along[0] ** 2 + along[1] ** 2
    share = 0.0 if square == 0.0 else max(0.0, min(1.0, -(start[0] * along[0] + start[1] * along[1]) / square))
    return start[0] + share * along[0], start[1] + share * along[1]


def _ray(start: tuple[float, float], end: tuple[float, float], bearing: float) -> float | None:
    """Return the m from 0/0 to a segment in a direction; None if it is not there."""
    north, east = math.cos(bearing), math.sin(bearing)
    along_north, along_east = end[0] - start[0], end[1] - start[1]
    across = north * along_east - east * along_north
    if abs(across) < 1e-12:
        return None
    distance = (start[0] * along_east - start[1] * along_north) / across
    share = (start[0] * east - start[1] * north) / across
    return distance if distance >= 0.0 and 0.0 <= share <= 1.0 else None


def _gap(first: tuple[float, float], second: tuple[float, float], ahead: float, aside: float) -> float:
    """Return the distance between a segment and the rectangle within +-ahead and +-aside."""
    corners = [(ahead, aside), (ahead, -aside), (-ahead, -aside), (-ahead, aside)]
    if any(abs(x) <= ahead and abs(y) <= aside for x, y in (first, second)):
        return 0.0
    sides = list(zip(corners, [*corners[1:], corners[0]], strict=True))
    if any(_cross(first, second, *side) for side in sides):
        return 0.0
    from_corners = (math.dist(corner, _foot(first, second, corner)) for corner in corners)
    from_ends = (math.hypot(max(0.0, abs(x) - ahead), max(0.0, abs(y) - aside)) for x, y in (first, second))
    return min(*from_corners, *from_ends)


def _foot(first: tuple[float, float], second: tuple[float, float], point: tuple[float, float]) -> tuple[float, float]:
    x, y = _nearest((first[0] - point[0], first[1] - point[1]), (second[0] - point[0], second[1] - point[1]))
    return x + point[0], y + point[1]


def _cross(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float], d: tuple[float, float]) -> bool:
    def side(p: tuple[float, float], q: tuple[float, float], r: tuple[float, float]) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return side(a, b, c) * side(a, b, d) < 0.0 and side(c, d, a) * side(c, d, b) < 0.0
