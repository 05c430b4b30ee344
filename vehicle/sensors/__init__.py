"""Sensors: the Sensors protocol, and a vehicle without any; the simulated sensors are in vehicle/sim/body.py."""

from __future__ import annotations

from typing import Protocol

from vehicle.readings import NO_READINGS, Readings


class Sensors(Protocol):
    """All sensors of a vehicle. `read` is called in each control cycle and must never block."""

    def read(self, now: float) -> Readings:
        """Return the newest readings; None for values that are not measured."""


class NoSensors:
    """A rover without sensors."""

    def read(self, now: float) -> Readings:
        """Return empty readings."""
        return NO_READINGS
