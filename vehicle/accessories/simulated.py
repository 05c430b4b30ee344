"""An accessory that is none: telemetry (RELAY_STATUS, SERVO_OUTPUT_RAW) and tests see what it would get."""

from __future__ import annotations


class SimulatedAccessory:
    """Fits `vehicle.accessories.Accessory`; `value` is what a relay or a servo would get."""

    def __init__(self, value: int) -> None:
        self.value = value

    def set(self, value: int) -> None:
        """Hold it."""
        self.value = value

    def close(self) -> None:
        """There is no hardware to let go of."""
