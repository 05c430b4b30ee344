"""Walls of the simulation: what a sensor sees of them, and how near they are."""

from __future__ import annotations

import math
import random

import pytest

from vehicle.navigation.geo import Point
from vehicle.sim.chassis import ChassisMotion
from vehicle.sim.walls import FAR, SCAN_PERIOD, SimulatedLidar, Walls

WALL = Walls([(Point(2.0, -1.0), Point(2.0, 1.0))])


def test_a_scan_has_the_nearest_point_of_each_sector() -> None:
    scan = WALL.scan(Point(0.0, 0.0), 0.0, 8)
    assert scan[0] == pytest.approx(2.0)
    assert scan[1] == pytest.approx(math.hypot(2.0, math.tan(math.pi / 8) * 2.0), abs=0.01)
    assert scan[3] == math.inf
    assert WALL.scan(Point(0.0, 0.0), math.pi / 2, 8)[6] == pytest.approx(2.0)


def test_a_scan_agrees_with_many_rays() -> None:
    chance = random.Random(3)
    walls = Walls([(Point(chance.uniform(-3, 3), chance.uniform(-3, 3)), Point(chance.uniform(-3, 3), 4.0))
                   for _ in range(5)])  # fmt: skip
    fine, coarse = walls.scan(Point(0.0, 0.0), 0.4, 3600), walls.scan(Point(0.0, 0.0), 0.4, 36)
    for sector, distance in enumerate(coarse):
        rays = [fine[(100 * sector + each) % 3600] for each in range(-50, 51)]
        assert distance == pytest.approx(min(rays), abs=0.02) or min(rays) == distance == math.inf


@pytest.mark.parametrize(
    ("north", "yaw", "clearance"),
    [(0.0, 0.0, 1.8), (1.7, 0.0, 0.1), (1.9, 0.0, 0.0), (2.0, 0.0, 0.0), (2.5, 0.0, 0.3), (1.7, math.pi / 4, 0.0172)],
)
def test_the_clearance_is_that_of_the_outline(north: float, yaw: float, clearance: float) -> None:
    motion = ChassisMotion(north=north, yaw=yaw)
    assert WALL.clearance(motion, 0.4, 0.4) == pytest.approx(clearance, abs=1e-3)


def test_the_sensor_has_noise_dropouts_and_its_own_rate() -> None:
    lidar = SimulatedLidar(WALL, 1, dropouts=0.2)
    motion = ChassisMotion()
    scans = [lidar.read(motion, step * SCAN_PERIOD) for step in range(200)]
    assert lidar.read(motion, 199 * SCAN_PERIOD + 0.01) is scans[-1]
    seen = [reading.scan[0].distance or 0.0 for reading in scans]
    dropped = sum(distance == FAR for distance in seen)
    assert 20 <= dropped <= 60
    kept = [distance for distance in seen if distance != FAR]
    assert sum(kept) / len(kept) == pytest.approx(2.0, abs=0.01)
    assert max(kept) - min(kept) > 0.03
