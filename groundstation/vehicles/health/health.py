"""HealthReadings: the health of one vehicle in words, by line. A new message is a function and a row in READERS."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from dialects import messages as m
from dialects.enums import Sensor
from groundstation.snapshot.drive import HealthLine
from groundstation.vehicles.health.estimate_health import ekf_line, estimator_line

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


OLD = 10.0
"""s after which a line is shown as old: the slowest of these messages comes every 2 s."""

LOW_BATTERY = 0.25
MUCH_VIBRATION = 30.0
"""m/s2: ArduPilot's documentation calls less than 30 acceptable."""
HOT, BUSY = 80.0, 95.0
"""degC and % of a companion computer; a Pi throttles itself at 85."""
FIXES = {0: "none", 1: "no fix", 2: "2D", 3: "3D", 4: "DGPS", 5: "RTK float", 6: "RTK fixed"}
UNKNOWN_U16, UNKNOWN_U8, UNKNOWN_I8 = 0xFFFF, 0xFF, 127

Lines = list[HealthLine]


def _battery(message: m.BatteryStatus) -> Lines:
    if message.id != 0:
        return []
    cells = [cell for cell in message.voltages if cell != UNKNOWN_U16]
    return _battery_line(sum(cells) if cells else None, message.current_battery, message.battery_remaining)


def _battery_line(millivolts: int | None, centiamperes: int, percent: int) -> Lines:
    words = [
        *([f"{millivolts / 1000:.1f} V"] if millivolts else []),
        *([f"{centiamperes / 100:.1f} A"] if centiamperes >= 0 else []),
        *([f"{percent}%"] if 0 <= percent <= 100 else []),
    ]
    good = not 0 <= percent < 100 * LOW_BATTERY
    return [HealthLine("battery", "  ".join(words), good)] if words else []


def _gps(message: m.GpsRawInt) -> Lines:
    satellites = "" if message.satellites_visible == UNKNOWN_U8 else f", {message.satellites_visible} satellites"
    hdop = "" if message.eph in (0, UNKNOWN_U16) else f", hdop {message.eph / 100:.1f}"
    return [HealthLine("gps", f"{FIXES.get(message.fix_type, 'fix')}{satellites}{hdop}", message.fix_type >= 3)]


def _system(message: m.SysStatus) -> Lines:
    battery = _battery_line(
        message.voltage_battery if message.voltage_battery != UNKNOWN_U16 else None,
        message.current_battery,
        message.battery_remaining,
    )
    return [*battery, *sensor_lines(message)]


def _vibration(message: m.Vibration) -> Lines:
    axes = (message.vibration_x, message.vibration_y, message.vibration_z)
    worst = max(axes, key=lambda value: value if math.isfinite(value) else -1.0)
    if not math.isfinite(worst):
        return []
    clipped = message.clipping_0 + message.clipping_1 + message.clipping_2
    clips = f", {clipped} clipped" if clipped else ""
    return [HealthLine("vibration", f"{worst:.0f} m/s²{clips}", worst < MUCH_VIBRATION)]


def _computer(message: m.OnboardComputerStatus) -> Lines:
    load = message.cpu_cores[0]
    words = [
        *([f"load {load}%"] if load != UNKNOWN_U8 else []),
        *([f"{message.temperature_board} °C"] if message.temperature_board != UNKNOWN_I8 else []),
    ]
    hot = message.temperature_board != UNKNOWN_I8 and message.temperature_board >= HOT
    busy = load != UNKNOWN_U8 and load >= BUSY
    return [HealthLine("computer", ", ".join(words), not (hot or busy))] if words else []


READERS: dict[type[m.Message], Callable[[Any], Lines]] = {
    m.BatteryStatus: _battery,
    m.GpsRawInt: _gps,
    m.EkfStatusReport: lambda message: [ekf_line(message)],
    m.EstimatorStatus: lambda message: [estimator_line(message)],
    m.Vibration: _vibration,
    m.OnboardComputerStatus: _computer,
    m.SysStatus: _system,
}
"""Message -> its lines. The first message that tells of a subsystem wins, unless another one finds it not healthy."""


class HealthReadings:
    """The newest lines of each message."""

    def __init__(self) -> None:
        self._lines: dict[type[m.Message], tuple[float, Lines]] = {}

    def receive(self, message: m.Message, now: float) -> None:
        """Handle a message of the autopilot."""
        reader = READERS.get(type(message))
        if reader is not None:
            self._lines[type(message)] = (now, reader(message))

    def build_lines(self, now: float) -> tuple[HealthLine, ...]:
        """Return the lines, those to look at first."""
        found: dict[str, HealthLine] = {}
        for kind in READERS:
            at, lines = self._lines.get(kind, (now, []))
            for line in lines:
                known = found.get(line.name)
                if known is None:
                    found[line.name] = _aged(line, now - at)
                elif line.text == MISSING and known.good:  # PX4 enables what is to come, and a fix proves the receiver
                    continue
                elif line.good is False and known.good is not False:
                    found[line.name] = HealthLine(line.name, f"{line.text}, {known.text}", False)
        return tuple(sorted(found.values(), key=lambda line: (line.good is not False, line.good is None)))


def _aged(line: HealthLine, age: float) -> HealthLine:
    return line if age <= OLD else HealthLine(line.name, f"{line.text}, {age:.0f} s ago", None)
