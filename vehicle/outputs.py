"""The last gate before the motors: it refuses what it cannot vouch for, whoever asked for it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Outputs:
    """What the motors must get now. `throttles` are -1..1 in motor order: left, right or throttle, steering."""

    throttles: tuple[float, ...]
    enabled: bool
    """False: the driver's enable line is off too."""
