"""What the rover feels: the Sensors protocol, and the body without any; the simulated one is vehicle/sim/body.py."""

from __future__ import annotations

from typing import Protocol

from vehicle.readings import NO_READINGS, Readings


class Sensors(Protocol):
    """Everything a vehicle measures. `read` comes each control cycle, so it must never block: it gives the newest."""

    def read(self, now: float) -> Readings:
        """The newest readings; None for what is not measured."""


class NoSensors:
    """A rover that measures nothing, as the cheapest one does."""

    def read(self, now: float) -> Readings:
        """Nothing is known."""
        return NO_READINGS
