"""DISTANCE_SENSOR and OBSTACLE_DISTANCE as cones in the frame of the rover."""

from __future__ import annotations

import math

from dialects import messages as m
from vehicle.readings import Cone, Scan

UNKNOWN_DISTANCE = m.UINT16_MAX
"""Element of OBSTACLE_DISTANCE that was not measured."""
FRAMES_NORTH, FRAME_BODY = (0, 1), 12
"""MAV_FRAME_GLOBAL and MAV_FRAME_LOCAL_NED count from north, MAV_FRAME_BODY_FRD from the nose."""
YAW_ORIENTATIONS = 8
"""MAV_SENSOR_ORIENTATION 0 to 7: level, in steps of 45 degrees to the right."""
DEFAULT_FOV = math.radians(25)
"""Angle of a DISTANCE_SENSOR that does not report one: that of a VL53L0X, wider than those of lidars."""
SIGNAL_INVALID = 1
"""`signal_quality` of a measurement that is no distance; 0 is unknown."""


def parse_distance_sensor(message: m.DistanceSensor) -> Scan | str:
    """Return its cone, or why the message is not used."""
    if message.orientation >= YAW_ORIENTATIONS:
        return "does not look to a side"
    near, far = message.min_distance / 100, message.max_distance / 100
    if not near < far:
        return "min_distance is not below max_distance"
    fov = message.horizontal_fov
    width = fov if 0.0 < fov <= math.pi else DEFAULT_FOV  # false for NaN
    distance: float | None = min(message.current_distance / 100, far)
    if message.signal_quality == SIGNAL_INVALID:
        distance = None
    elif message.current_distance / 100 < near:
        distance = 0.0
    return (Cone(message.orientation * math.pi / 4, width / 2, distance, far),)


def parse_obstacle_distance(message: m.ObstacleDistance, yaw: float | None) -> Scan | str:
    """Return its cones, or why the message is not used. `yaw` of the rover: distances may count from north."""
    near, far = message.min_distance / 100, message.max_distance / 100
    step = math.radians(message.increment_f or message.increment)
    offset = math.radians(message.angle_offset)
    if not near < far:
        return "min_distance is not below max_distance"
    if not (0.0 < abs(step) <= math.pi and math.isfinite(offset)):  # false for NaN
        return "angles are not numbers, or 0"
    if message.frame in FRAMES_NORTH:
        if yaw is None:
            return "counts from north, and the heading is not known"
        offset -= yaw
    elif message.frame != FRAME_BODY:
        return f"frame {message.frame} is not known"
    count = min(len(message.distances), int(math.tau / abs(step) + 0.5))
    return tuple(
        Cone((offset + index * step) % math.tau, abs(step) / 2, _measured(value, near, far), far, central=True)
        for index, value in enumerate(message.distances[:count])
    )


def _measured(value: int, near: float, far: float) -> float | None:
    if value == UNKNOWN_DISTANCE:
        return None
    return 0.0 if value / 100 < near else min(value / 100, far)


def angle_between(first: float, second: float) -> float:
    """Return the angle between two bearings, 0 to pi."""
    return abs((first - second + math.pi) % math.tau - math.pi)
