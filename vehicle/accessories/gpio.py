"""A relay, or whatever else is switched, at a pin of a Raspberry Pi, through gpiozero and lgpio.

There is no servo here: lgpio makes pulses in software, by which a servo fidgets (its own words), and gpiozero hands it
steps of 200 us.
"""

from __future__ import annotations

from typing import Any

import msgspec

from vehicle.motors.settings import Pin, pin_name


class GpioRelaySettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A pin."""

    pin: Pin
    """BCM number."""
    active_high: bool = True
    """False for a board that switches on when its input is low, as many with optocouplers."""

    @property
    def taken(self) -> list[str]:
        """The pin."""
        return [pin_name(self.pin)]


class GpioRelay:
    """Fits `vehicle.accessories.Accessory`. Once closed the pin is an input: what the relay is then is its board's."""

    Settings = GpioRelaySettings

    def __init__(self, settings: GpioRelaySettings, value: int, *, pin_factory: Any = None) -> None:
        """`pin_factory` is gpiozero's; None takes the one of this machine. Raises MotorError."""
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
        """Switch it. Raises MotorError."""
        with self._translated("pin"):
            self._pin.value = bool(value)

    def close(self) -> None:
        """Let go of the pin."""
        with self._translated("pin"):
            self._pin.close()
