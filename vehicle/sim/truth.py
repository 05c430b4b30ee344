"""A record of where the simulated rover really is, which none of its sensors knows: for tests and benchmarks that look
at a vehicle from outside.

A line ten times a second: `<clock ns> <m north> <m east> <rad> <m/s>`, from where it started.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from vehicle.readings import Readings
from vehicle.sim.body import SimulatedBody

PERIOD = 0.1
"""s between two lines; at 1.5 m/s the rover moves 15 cm."""


class RecordedBody:
    """Fits `vehicle.sensors.Sensors`. `write` takes lines; `clock` gives ns that other processes share."""

    def __init__(self, body: SimulatedBody, write: Callable[[str], None], clock: Callable[[], int]) -> None:
        self._body = body
        self._write = write
        self._clock = clock
        self._due = -math.inf

    def read(self, now: float) -> Readings:
        """What the body's sensors say."""
        readings = self._body.read(now)
        if now >= self._due:
            self._due = now + PERIOD
            motion = self._body.motion
            self._write(f"{self._clock()} {motion.north:.3f} {motion.east:.3f} {motion.yaw:.4f} {motion.speed:.3f}\n")
        return readings
