"""What a rover has beside its motors: relays and servos, one protocol for all, and the table of their drivers.

Numbers are ArduPilot's: relays from 0, servos by the number of their output, 1 to 16. An accessory is never a motor:
numbers, pins and channels of motors are refused before anything is opened (vehicle/config/conflicts.py, vehicle/runtime/factory.py).

To add a driver, write a class that fits `Accessory`, add one line to DRIVERS, and test it with
tests/vehicle/accessories/contract.py. A driver of your own needs no line: name it "module:Class".
A driver that has settings names their type `Settings` (a msgspec.Struct) and is made with one before its value:
`Class(settings, value)`, else `Class(value)`.
"""

from __future__ import annotations

from typing import Protocol

DRIVERS: dict[str, dict[str, str]] = {
    "relay": {
        "simulated": "vehicle.accessories.simulated:SimulatedAccessory",
        "gpio": "vehicle.accessories.gpio:GpioRelay",
    },
    "servo": {
        "simulated": "vehicle.accessories.simulated:SimulatedAccessory",
        "pca9685": "vehicle.accessories.pca9685:Pca9685Servo",
    },
}
"""Kind -> name -> "module:Class". Imported only when asked for: a driver's library is installed only where its hardware
is."""

LARGEST_RELAY, LARGEST_SERVO = 15, 16
"""Numbers: RELAY_STATUS and SERVO_OUTPUT_RAW have room for so many."""
TIMES_MAX, PERIOD_MAX = 1000, 3600.0
"""Of a repeat: how often, and s between two changes."""
OFF = 0
"""Of a relay; of a servo that it gets no pulses."""


class Accessory(Protocol):
    """One relay or one servo, which gives the value it is made with from the beginning.

    Both verbs are called between two control cycles and must not wait. They may raise anything: it is told to the
    driver, and tried again.
    """

    def set(self, value: int) -> None:
        """Give it: of a relay 0 or 1, of a servo the pulse in us, or 0 for no pulses."""

    def close(self) -> None:
        """Let go of the hardware. May come twice."""
