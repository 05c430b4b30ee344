"""Obstacles as bearings and distances: our vehicle's, those of others, and what is no obstacle."""

from __future__ import annotations

import math
from typing import Any

from dialects import messages as m
from groundstation.vehicles.readings.obstacles import UNKNOWN, ObstacleReadings


def scan(*distances: int, **changes: Any) -> m.ObstacleDistance:
    values: dict[str, Any] = {
        "time_usec": 0,
        "sensor_type": 0,
        "min_distance": 1,
        "max_distance": 1000,
        "increment": 5,
        "increment_f": 5.0,
        "frame": 12,
    }
    return m.ObstacleDistance(distances=[*distances, *[UNKNOWN] * (72 - len(distances))], **(values | changes))


def sensor(distance: int, orientation: int = 0, number: int = 0) -> m.DistanceSensor:
    return m.DistanceSensor(0, 1, 1000, distance, 0, number, orientation, 255)


def test_a_scan_is_turned_to_the_nose() -> None:
    readings = ObstacleReadings()
    assert readings.nearest(0.0, newest=True) is None
    readings.handle_around(scan(1001, 80, 300), None, 0.0)
    assert readings.nearest(0.0, newest=True) == (0.087, 0.8)
    assert len(readings.around(1.0)) == 2
    readings.handle_around(scan(70, frame=0), math.radians(90), 1.0)  # it counts from north, and the nose points east
    assert readings.nearest(1.0, newest=True) == (4.712, 0.7)
    readings.handle_around(scan(10, frame=0), None, 1.1)  # without a heading it says nothing
    readings.handle_around(scan(10, frame=3), 0.0, 1.1)
    assert readings.around(1.1)[0][1] == 0.7
    readings.handle_around(scan(50, increment=10, increment_f=math.nan, angle_offset=math.inf), None, 1.2)
    assert readings.around(1.2) == ((0.0, 0.5),)
    assert readings.around(9.0) == ()
    assert readings.nearest(9.0, newest=False) is None


def test_our_newest_report_counts_and_the_nearest_of_others() -> None:
    readings = ObstacleReadings()
    readings.handle_around(scan(60), None, 0.0)
    readings.handle_sensor(sensor(200, 2), 0.5)
    assert readings.nearest(0.5, newest=True) == (math.pi / 2, 2.0)
    assert readings.nearest(0.5, newest=False) == (0.0, 0.6)


def test_a_sensor_that_sees_nothing_or_looks_down_is_none() -> None:
    readings = ObstacleReadings()
    readings.handle_sensor(sensor(1000, 0, 1), 0.0)
    readings.handle_sensor(sensor(20, 25, 2), 0.0)
    assert readings.around(0.0) == ()
    readings.handle_sensor(sensor(90, 4, 3), 0.0)
    assert readings.around(0.0) == ((math.pi, 0.9),)
    readings.handle_sensor(sensor(1000, 4, 3), 0.1)
    assert readings.nearest(0.1, newest=False) is None
