"""The operator overrides the limits before obstacles by a held key: for a sensor that sees a wall where none is."""

from __future__ import annotations

import math

from dialects.enums import Severity
from vehicle.drive.demand import Demand
from vehicle.proximity.obstacles import OVERRIDE_SPEED, Obstacles
from vehicle.statustext import StatusTextQueue

LONGEST = 10.0
"""s after which the key must be let go: a key that is stuck, or taped down, does not switch avoidance off."""


class ObstacleOverride:
    """Only the proof of a session in control can say that the key is held (ROVER_OPERATOR_FLAGS_OVERRIDE)."""

    def __init__(self, obstacles: Obstacles, texts: StatusTextQueue) -> None:
        self._obstacles = obstacles
        self._texts = texts
        self._since: float | None = None

    def update(self, demand: Demand | None, now: float) -> None:
        """Set whether limits are overridden now. `demand` is that of the driver while it is fresh."""
        held = demand is not None and demand.override
        if not held:
            self._since = None
        elif self._since is None:
            self._since = now
        since = math.inf if self._since is None else self._since
        overridden = since <= now < since + LONGEST
        if overridden != self._obstacles.overridden:
            self._obstacles.overridden = overridden
            who = f"GCS {demand.system}: " if demand is not None else ""
            text = f"obstacles overridden, {OVERRIDE_SPEED:g} m/s" if overridden else "obstacles count again"
            self._texts.send_event(Severity.WARNING, f"{who}{text}", now)
