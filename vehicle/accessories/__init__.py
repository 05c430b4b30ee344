"""Accessories: relays and servos beside the motors, behind one protocol.

Numbers are ArduPilot's: relays from 0, servos by their output number, 1 to 16. An accessory is never a motor: numbers,
pins and channels of motors are rejected before anything is opened (vehicle/config/conflicts.py,
vehicle/runtime/factory.py).

To add a driver, write a class that fits `Accessory`, add one row to DRIVERS in vehicle/accessories/drivers.py, and test
the class with tests/vehicle/accessories/contract.py. A driver outside this package needs no row: name it
"module:Class". A driver with settings names their type `Settings` (a msgspec.Struct) and is built as
`Class(settings, value)`, any other as `Class(value)`.

To add or change:
- a relay or servo driver: a class that fits `vehicle/accessories/__init__.py`, and its row in
  `vehicle/accessories/drivers.py`, `DRIVERS`.
"""

from __future__ import annotations

from typing import Protocol

LARGEST_RELAY, LARGEST_SERVO = 15, 16
"""Largest numbers: what RELAY_STATUS and SERVO_OUTPUT_RAW have fields for."""
TIMES_MAX, PERIOD_MAX = 1000, 3600.0
"""Limits of DO_REPEAT_RELAY and DO_REPEAT_SERVO: repetitions, and s between two changes."""
OFF = 0
"""Value of a relay that is off, or of a servo without pulses."""


class Accessory(Protocol):
    """One relay or one servo. It outputs the value it was built with from the start.

    Both methods are called between two control cycles and must not block. They may raise anything: the error is
    reported to the operator, and the call is repeated.
    """

    def set(self, value: int) -> None:
        """Set the value: 0 or 1 for a relay, the pulse in us (0 for no pulses) for a servo."""

    def close(self) -> None:
        """Release the hardware. May be called twice."""
