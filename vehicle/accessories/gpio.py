"""A relay or another switched load on a GPIO pin of a Raspberry Pi, through gpiozero and lgpio.

There is no servo driver here: the software pulses of lgpio make a servo jitter, and gpiozero has steps of 200 us only.
"""

from __future__ import annotations

from typing import Any

import msgspec

from vehicle.motors.settings import Pin, pin_name


class GpioRelaySettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A relay on a pin."""

    pin: Pin
    """BCM number."""
    active_high: bool = True
    """False for a board that switches on when its input is low, like many with optocouplers."""

    @property
    def taken(self) -> list[str]:
        """The pin by name."""
        return [pin_name(self.pin)]


class GpioRelay:
    """Fits `vehicle.accessories.Accessory`. A closed pin is an input: the relay board decides on the state then."""

    Settings = GpioRelaySettings

    def __init__(self, settings: GpioRelaySettings, value: int, *, pin_factory: Any = None) -> None:
        """Open the pin. `pin_factory` is gpiozero's; None selects the one of this machine. Raises MotorError."""
        from vehicle.motors.pins import DigitalOutputDevice, translated

        self._translated = translated
        with translated("pin"):
            self._pin: Any = DigitalOutputDevice(
                settings.pin,
                active_high=settings.active_high,
                initial_value=bool(value),
                pin_factory=pin_factory,
            )

    def set(self, value: int) -> None:
        """Switch the relay on or off. Raises MotorError."""
        with self._translated("pin"):
            self._pin.value = bool(value)

    def close(self) -> None:
        """Release the pin."""
        with self._translated("pin"):
            self._pin.close()
