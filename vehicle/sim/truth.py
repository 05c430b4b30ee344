"""A log of the true position of the simulated rover, for tests and benchmarks that observe a vehicle from outside.

Ten lines per second: `<clock ns> <m north> <m east> <rad> <m/s>`, relative to the start. With walls the m to the
nearest one follow, 0 in contact.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from vehicle.readings import Readings
from vehicle.sim.body import SimulatedBody

PERIOD = 0.1
"""s between two lines; at 1.5 m/s the rover moves 15 cm."""


class RecordedBody:
    """Fits `vehicle.sensors.Sensors`. `write` appends lines; `clock` returns ns of CLOCK_MONOTONIC."""

    def __init__(self, body: SimulatedBody, write: Callable[[str], None], clock: Callable[[], int]) -> None:
        self._body = body
        self._write = write
        self._clock = clock
        self._due = -math.inf

    def read(self, now: float) -> Readings:
        """Return the readings of the body, and log its true position every PERIOD."""
        readings = self._body.read(now)
        if now >= self._due:
            self._due = now + PERIOD
            motion = self._body.motion
            line = f"{self._clock()} {motion.north:.3f} {motion.east:.3f} {motion.yaw:.4f} {motion.speed:.3f}"
            clearance = self._body.clearance
            self._write(f"{line}\n" if clearance is None else f"{line} {clearance:.3f}\n")
        return readings
