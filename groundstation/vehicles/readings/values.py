"""Values of messages as the screen shows them."""

from __future__ import annotations

import math
from functools import lru_cache

from dialects import messages as m
from dialects.enums import Autopilot, DriveLimit, Failsafe

_AUTOPILOTS: dict[int, str] = {Autopilot.ARDUPILOT: "ArduPilot ", Autopilot.PX4: "PX4 "}


@lru_cache(maxsize=256)
def vehicle_name(autopilot: int, word: str, system: int) -> str:
    """Return a name for the driver, e.g. "Rover 1", "ArduPilot rover 1". `word` is that of its kind."""
    text = f"{_AUTOPILOTS.get(autopilot, '')}{word} {system}"
    return text[0].upper() + text[1:]


def battery_values(volts: float | None, centiamperes: int, percent: int) -> dict[str, float | None]:
    """Return the battery's fields of VehicleView."""
    return {
        "battery_voltage": volts,
        "battery_current": centiamperes / 100 if centiamperes >= 0 else None,
        "battery_remaining": percent / 100 if 0 <= percent <= 100 else None,
    }


@lru_cache(maxsize=256)
def flag_words(flags: type[DriveLimit] | type[Failsafe], value: int) -> tuple[str, ...]:
    """Return the names of the flags in `value`, e.g. "neutral first"; unknown bits are left out."""
    return tuple(str(flag.name).replace("_", " ").lower() for flag in flags if value & flag)


def drive_demand(drive: m.RoverDriveStatus | None) -> tuple[float, float] | None:
    """Return throttle and steering of the demand in use, -1..1; None where it is not known."""
    return (within(drive.demand_throttle / 10_000), within(drive.demand_steering / 10_000)) if drive else None


SLOWED = {
    DriveLimit.OBSTACLE: "obstacle",
    DriveLimit.RANGE_SENSOR: "range sensor",
    DriveLimit.FRESHNESS: "late commands",
}
"""Limit of which ROVER_DRIVE_STATUS has the speed -> its reason, the most important first."""


def slowed_speed(drive: m.RoverDriveStatus | None) -> tuple[float, str] | None:
    """Return m/s that the vehicle allows itself and the reason; None where no limit holds it back."""
    reason = next((text for limit, text in SLOWED.items() if drive is not None and drive.limits & limit), None)
    return None if drive is None or reason is None else (drive.speed_limit / 100, reason)


def within(value: float) -> float:
    """Return a value limited to -1..1."""
    return max(-1.0, min(1.0, value))


def all_finite(*values: float) -> bool:
    """Return whether all values are numbers."""
    return all(math.isfinite(value) for value in values)
