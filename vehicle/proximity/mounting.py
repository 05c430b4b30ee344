"""Where range sensors look, and what of their range counts: RNGFNDn_ and PRX1_ parameters."""

from __future__ import annotations

import math

from vehicle.params import Params
from vehicle.readings import RangeReading, Scan

AS_IT_IS, AROUND = -1, 0
"""`mount` of a reading: directions are those of the rover already; or PRX1_ says how the sensor is mounted.

From 1 on it is the number of a rangefinder (RNGFND1_ORIENT)."""


def mount_reading(reading: RangeReading, params: Params) -> Scan:
    """Return the scan of a sensor of this computer in the frame of the rover."""
    if reading.mount == AS_IT_IS:
        return reading.scan
    return mount_around(reading.scan, params) if reading.mount == AROUND else _mount_single(reading, params)


def mount_around(scan: Scan, params: Params) -> Scan:
    """Return the cones of a sensor that looks around (PRX1_ORIENT, _YAW_CORR), within PRX1_MIN and PRX1_MAX."""
    sign = -1.0 if params["PRX1_ORIENT"] else 1.0
    turned, near = math.radians(params["PRX1_YAW_CORR"]), params["PRX1_MIN"]
    found = []
    for cone in scan:
        far = min(cone.far, params["PRX1_MAX"] or cone.far)
        distance = cone.distance
        if distance is not None and (distance > far or distance < near):
            distance = far
        bearing = (sign * cone.bearing + turned) % math.tau
        found.append(cone._replace(bearing=bearing, distance=distance, far=far))
    return tuple(found)


def _mount_single(reading: RangeReading, params: Params) -> Scan:
    """Return the cone of a rangefinder: nearer than _MIN is 0 m, and farther than _MAX is nothing."""
    name = f"RNGFND{reading.mount}"
    [cone] = reading.scan
    far = min(cone.far, params[f"{name}_MAX"] or cone.far)
    distance = cone.distance
    if distance is not None:
        distance = 0.0 if distance < params[f"{name}_MIN"] else min(distance, far)
    return (cone._replace(bearing=params[f"{name}_ORIENT"] * math.pi / 4, distance=distance, far=far),)
