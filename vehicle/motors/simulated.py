"""Motors that turn nothing: they hold their throttles for the simulated rover (vehicle/sim) and for tests to see."""

from __future__ import annotations

from collections.abc import Sequence

from vehicle.motors import check_throttles


class SimulatedMotors:
    """Fits `vehicle.motors.Motors`; `outputs` is what wheels would get."""

    def __init__(self, count: int = 2) -> None:
        self.count = count
        self.enabled = False
        self._throttles = self._neutral = (0.0,) * count

    @property
    def outputs(self) -> tuple[float, ...]:
        """What each wheel gets now, -1..1; neutral while disabled."""
        return self._throttles if self.enabled else self._neutral

    def enable(self) -> None:
        """Let the motors turn, from neutral."""
        if not self.enabled:
            self._throttles = self._neutral
            self.enabled = True

    def disable(self) -> None:
        """No power: `outputs` is neutral until enabled and set again."""
        self.enabled = False
        self._throttles = self._neutral

    def set(self, throttles: Sequence[float]) -> None:
        """Hold `throttles`. Raises MotorError as every driver does."""
        self._throttles = check_throttles(throttles, self.count)

    def close(self) -> None:
        """Neutral and disabled; there is no hardware to let go of."""
        self.disable()
