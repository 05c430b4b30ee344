"""Health of the sensors in SYS_STATUS: present, enabled and healthy as one word for each subsystem."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Sensor
from groundstation.snapshot.drive import HealthLine

NAMES: dict[int, str] = {
    1 << 0: "gyro", 1 << 1: "accel", 1 << 2: "compass", 1 << 3: "pressure", 1 << 4: "airspeed", 1 << 5: "gps",
    1 << 6: "flow", 1 << 7: "vision", 1 << 8: "range", 1 << 9: "truth", 1 << 10: "rates", 1 << 11: "attitude",
    1 << 12: "yaw", 1 << 13: "altitude", 1 << 14: "position", 1 << 15: "motors", 1 << 16: "RC", 1 << 17: "gyro 2",
    1 << 18: "accel 2", 1 << 19: "compass 2", 1 << 20: "fence", 1 << 21: "estimate", 1 << 22: "terrain",
    1 << 23: "reverse", 1 << 24: "logging", 1 << 25: "battery", 1 << 26: "proximity", 1 << 27: "satcom",
    1 << 29: "avoidance", 1 << 30: "thrust",
}  # fmt: skip
"""Bit of MAV_SYS_STATUS_SENSOR -> name, at most 9 characters. Pre-arm has a place of its own on the screen."""


MISSING = "missing"


def sensor_lines(message: m.SysStatus) -> list[HealthLine]:
    """Return a line for each subsystem that is enabled, or present and not enabled; those to look at come first."""
    present, enabled, healthy = (
        message.onboard_control_sensors_present,
        message.onboard_control_sensors_enabled,
        message.onboard_control_sensors_health,
    )
    lines = [
        HealthLine(name, *_state(bool(present & bit), bool(enabled & bit), bool(healthy & bit)))
        for bit, name in NAMES.items()
        if (present | enabled) & bit and bit != Sensor.PREARM
    ]
    return sorted(lines, key=lambda line: (line.good is not False, line.good is None))


def _state(present: bool, enabled: bool, healthy: bool) -> tuple[str, bool | None]:
    if not enabled:
        return "off", None
    if not present:
        return MISSING, False
    return ("ok", True) if healthy else ("not healthy", False)
