"""One program at a time for one set of motors, also where the hardware itself does not see to that (pins, I2C, PWM).

The lock is a name in the kernel, which forgets it with the process, however that ends. Stopping needs no lock.
"""

from __future__ import annotations

import socket
from collections.abc import Mapping
from typing import Any

from vehicle.motors import DRIVERS, MotorError

SIMULATED = "simulated"


class InUseError(MotorError):
    """Another program has these motors."""


class MotorLock:
    """Held until `close`, or until the process ends."""

    def __init__(self, motors: Mapping[str, Any]) -> None:
        """`motors` is the table of settings. Raises InUseError."""
        self._socket: socket.socket | None = None
        name = _name(motors)
        if name is None:
            return
        holder = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC)
        try:
            holder.bind(name)
        except OSError as error:
            holder.close()
            words = "the motors are in use by another vehicle; end it first, a service by: sudo systemctl stop rover"
            raise InUseError(words) from error
        self._socket = holder

    def close(self) -> None:
        """Let go."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None


def _name(motors: Mapping[str, Any]) -> str | None:
    """The same for all names of one driver, and apart for each serial port.

    Simulated motors may run as often as you like, and a driver of your own may know better.
    """
    driver = motors["driver"]
    if driver == SIMULATED or driver not in DRIVERS:
        return None
    return f"\0mavhelm motors {DRIVERS[driver]} {motors.get('port', '')}"
