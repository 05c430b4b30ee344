"""Values of messages as the screen shows them."""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.enums import DriveLimit, Failsafe


def flag_words(flags: type[DriveLimit] | type[Failsafe], value: int) -> tuple[str, ...]:
    """Return the names of the flags in `value`, e.g. "neutral first"; unknown bits are left out."""
    return tuple(str(flag.name).replace("_", " ").lower() for flag in flags if value & flag)


def drive_demand(drive: m.RoverDriveStatus | None) -> tuple[float, float] | None:
    """Return throttle and steering of the demand in use, -1..1; None where it is not known."""
    return (within(drive.demand_throttle / 10_000), within(drive.demand_steering / 10_000)) if drive else None


def within(value: float) -> float:
    """Return a value limited to -1..1."""
    return max(-1.0, min(1.0, value))


def all_finite(*values: float) -> bool:
    """Return whether all values are numbers."""
    return all(math.isfinite(value) for value in values)
