"""Motors without hardware: they keep their throttles for the simulated rover (vehicle/sim) and for tests."""

from __future__ import annotations

from collections.abc import Sequence

from vehicle.motors import check_throttles


class SimulatedMotors:
    """Fits `vehicle.motors.Motors`; `outputs` holds the effective throttles."""

    def __init__(self, count: int = 2) -> None:
        self.count = count
        self.enabled = False
        self._throttles = self._neutral = (0.0,) * count

    @property
    def outputs(self) -> tuple[float, ...]:
        """Effective throttle of each motor, -1 to 1; neutral while disabled."""
        return self._throttles if self.enabled else self._neutral

    def enable(self) -> None:
        """Let the motors turn, from neutral."""
        if not self.enabled:
            self._throttles = self._neutral
            self.enabled = True

    def disable(self) -> None:
        """Disable the motors: `outputs` is neutral until they are enabled and set again."""
        self.enabled = False
        self._throttles = self._neutral

    def set(self, throttles: Sequence[float]) -> None:
        """Keep `throttles`. Raises MotorError for an invalid value."""
        self._throttles = check_throttles(throttles, self.count)

    def close(self) -> None:
        """Disable the motors."""
        self.disable()
