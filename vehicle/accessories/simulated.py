"""An accessory without hardware, whose value telemetry (RELAY_STATUS, SERVO_OUTPUT_RAW) and tests read."""

from __future__ import annotations


class SimulatedAccessory:
    """Fits `vehicle.accessories.Accessory`; `value` is the last value set."""

    def __init__(self, value: int) -> None:
        self.value = value

    def set(self, value: int) -> None:
        """Keep the value."""
        self.value = value

    def close(self) -> None:
        """Return: there is no hardware to release."""
