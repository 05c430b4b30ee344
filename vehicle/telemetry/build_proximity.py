"""Builds OBSTACLE_DISTANCE and DISTANCE_SENSOR: what all range sensors see, for ground stations."""

from __future__ import annotations

import math

from dialects import messages as m
from vehicle.proximity.cones import FRAME_BODY
from vehicle.proximity.obstacles import SECTORS
from vehicle.telemetry.view import TelemetryView

NEAREST, FARTHEST = 1, 1000
"""cm that are reported."""
NOTHING = FARTHEST + 1
"""No obstacle, as OBSTACLE_DISTANCE has it."""
LASER, ULTRASOUND, UNKNOWN_TYPE = 0, 1, 4
"""MAV_DISTANCE_SENSOR."""


def obstacle_distance(view: TelemetryView) -> m.Message | None:
    """Build OBSTACLE_DISTANCE: from the outline, clockwise from the nose; None without range sensors."""
    if not view.obstacles.sources:
        return None
    distances = [NOTHING if each is None else _centimetres(each) for each in view.obstacles.nearest()]
    return m.ObstacleDistance(
        time_usec=view.boot_us, sensor_type=LASER, distances=distances, increment=round(360 / SECTORS),
        min_distance=NEAREST, max_distance=FARTHEST, increment_f=360.0 / SECTORS, angle_offset=0.0, frame=FRAME_BODY,
    )  # fmt: skip


def distance_sensor(view: TelemetryView) -> m.Message | None:
    """Build DISTANCE_SENSOR: the nearest obstacle and its direction, in steps of 45 degrees; None if there is none."""
    nearest = view.obstacles.nearest()
    seen = [(distance, sector) for sector, distance in enumerate(nearest) if distance is not None]
    if not seen:
        return None
    distance, sector = min(seen)
    return m.DistanceSensor(
        time_boot_ms=view.boot_ms, min_distance=NEAREST, max_distance=FARTHEST, current_distance=_centimetres(distance),
        type=UNKNOWN_TYPE, id=0, orientation=round(sector * 8 / SECTORS) % 8, covariance=255,
        horizontal_fov=math.tau / 8,
    )  # fmt: skip


def _centimetres(distance: float) -> int:
    return max(NEAREST, min(FARTHEST, round(100 * distance)))
