"""Drivers with bugs, named on a command line as `tests.vehicle.motors.breaking:CLASS` to see how the vehicle ends."""

from __future__ import annotations

from collections.abc import Sequence

from vehicle.motors import MotorError
from vehicle.motors.simulated import SimulatedMotors

TURNS = 25
"""Writes while turning before the bug strikes: half a second, so that a test sees wheels turn."""


class RaisesWhileTurning(SimulatedMotors):
    """Its `set` ends in an error that no driver may raise."""

    def __init__(self) -> None:
        super().__init__(2)
        self._turns = 0

    def set(self, throttles: Sequence[float]) -> None:
        self._turns += any(throttles)
        if self._turns > TURNS:
            raise ZeroDivisionError("a bug in the driver")
        super().set(throttles)


class CannotStop(RaisesWhileTurning):
    """... and whose power cannot be taken away either from then on; a disarm before it is obeyed."""

    def disable(self) -> None:
        if self._turns > TURNS:
            raise OSError("bus is gone")
        super().disable()


class NoHardware:
    """Finds no hardware when opened."""

    def __init__(self) -> None:
        raise MotorError("no board at address 0x40")
