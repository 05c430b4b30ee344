"""Parses the JSON reports of gpsd; the connection is in vehicle/sensors/gps.py.

gpsd sends one object per line: TPV is the fix, SKY the satellites (https://gpsd.io/gpsd_json.html). Other objects,
invalid lines and invalid values are ignored.
"""

from __future__ import annotations

import json
import math
from typing import Any

import msgspec

MODE_FIX = {1: 1, 2: 2, 3: 3}
"""TPV mode -> GPS_FIX_TYPE: no fix, 2D, 3D."""
STATUS_FIX = {2: 4, 3: 6, 4: 5}
"""TPV status of a 3D fix -> GPS_FIX_TYPE: DGPS, RTK fixed, RTK float."""


class GpsFix(msgspec.Struct, frozen=True):
    """One TPV report; degrees, m, m/s. None for values that it lacks."""

    fix_type: int
    """GPS_FIX_TYPE."""
    latitude: float | None = None
    longitude: float | None = None
    altitude: float | None = None
    """Above mean sea level."""
    velocity_north: float | None = None
    velocity_east: float | None = None


class GpsSky(msgspec.Struct, frozen=True):
    """One SKY report: satellites and precision."""

    satellites: int | None = None
    """Satellites in use."""
    hdop: float | None = None


def parse(line: bytes) -> GpsFix | GpsSky | None:
    """Parse one line of gpsd; None for any other object. Never raises."""
    try:
        report = json.loads(line)
    except (ValueError, RecursionError):
        return None
    if not isinstance(report, dict):
        return None
    match report.get("class"):
        case "TPV":
            return _fix(report)
        case "SKY":
            return _sky(report)
        case _:
            return None


def _fix(report: dict[str, Any]) -> GpsFix:
    fix = MODE_FIX.get(_whole(report, "mode") or 0, 0)
    latitude, longitude = _number(report, "lat", 90.0), _number(report, "lon", 180.0)
    if fix < 2 or latitude is None or longitude is None:
        return GpsFix(min(fix, 1))
    if fix == 3:
        fix = STATUS_FIX.get(_whole(report, "status") or 0, 3)
    altitude = _number(report, "altMSL", 1e5)
    if altitude is None:
        altitude = _number(report, "alt", 1e5)  # before gpsd 3.20
    return GpsFix(fix, latitude, longitude, altitude if fix >= 3 else None, *_velocity(report))


def _velocity(report: dict[str, Any]) -> tuple[float | None, float | None]:
    speed, track = _number(report, "speed", 1e3), _number(report, "track", 360.0)
    if speed is None or (track is None and speed):
        return None, None
    heading = math.radians(track or 0.0)  # a receiver at rest reports no track
    return speed * math.cos(heading), speed * math.sin(heading)


def _sky(report: dict[str, Any]) -> GpsSky | None:
    satellites = _whole(report, "uSat")
    listed = report.get("satellites")
    if satellites is None and isinstance(listed, list):  # before gpsd 3.21
        satellites = sum(1 for each in listed if isinstance(each, dict) and each.get("used") is True)
    hdop = _number(report, "hdop", 1e3)
    return None if satellites is None and hdop is None else GpsSky(satellites, hdop)


def _number(report: dict[str, Any], name: str, largest: float) -> float | None:
    value = report.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if abs(value) <= largest else None  # also rejects NaN


def _whole(report: dict[str, Any], name: str) -> int | None:
    value = report.get(name)
    return value if isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= 255 else None
