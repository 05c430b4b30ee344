"""Own motor driver: `PYTHONPATH=docs/examples mavhelm vehicle udpin:127.0.0.1:14550 --motors my_motors:PrintMotors`.

The rules for a driver are in vehicle/motors/__init__.py; tests/test_examples.py runs the contract test on this one.
"""

from __future__ import annotations

from collections.abc import Sequence

from vehicle.motors import check_throttles


class PrintMotors:
    """Two motors that print their throttles instead of turning."""

    count = 2

    def __init__(self) -> None:
        self.enabled = False
        self.throttles = self.neutral = (0.0,) * self.count

    def enable(self) -> None:
        """Apply power, from neutral."""
        if not self.enabled:
            self.throttles, self.enabled = self.neutral, True

    def disable(self) -> None:
        """Remove the power."""
        self.throttles, self.enabled = self.neutral, False

    def set(self, throttles: Sequence[float]) -> None:
        """Set each motor's throttle, -1..1. Raises MotorError."""
        wanted = check_throttles(throttles, self.count)
        if self.enabled and wanted != self.throttles:
            print(*(f"{throttle:+.2f}" for throttle in wanted), flush=True)
            self.throttles = wanted

    def close(self) -> None:
        """Set neutral and disable."""
        self.disable()
