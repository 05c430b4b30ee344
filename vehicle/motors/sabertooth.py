"""Dimension Engineering Sabertooth (two motors) in packetized serial mode: a transmit line only, no replies.

The controller stops its motors after its serial timeout without a frame. The timeout is off by default, is lost with
the power (user guide 2x12, command 14), and cannot be read back. So this driver sets the timeout at each enable and
again each second, and enables no motor before the user has tested the timeout: pull the signal wire while the wheels
turn in the air, see them stop, and set `timeout_proven = true`.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Annotated, Literal

import msgspec

from vehicle.motors import check_throttles
from vehicle.motors.serial_controller import SerialController, SerialSettings

BAUDING = bytes([170])
"""First byte after power-up for models that detect the baud rate; others ignore it."""
FORWARD = (0, 4)
"""Command for forward of motor 1 and 2; plus one is backward."""
SET_TIMEOUT = 14
FULL = 127
REPEATS = 3
"""A stop is not acknowledged, so it is sent three times."""


class SabertoothSettings(SerialSettings, frozen=True, forbid_unknown_fields=True):
    """One Sabertooth: motor 1 is the left one, motor 2 the right one."""

    baud: Literal[2400, 9600, 19200, 38400] = 9600
    """Baud rate; 9600 is the default of the controller. At 2400 a write to both motors takes 33 ms, longer than a
    control cycle."""
    address: Annotated[int, msgspec.Meta(ge=128, le=135)] = 128
    timeout: Annotated[float, msgspec.Meta(ge=0.1, le=0.5)] = 0.3
    """s without a frame until the controller stops, in steps of 0.1."""
    timeout_proven: bool = False
    """You have pulled the signal wire while the wheels turned in the air, and they stopped."""


class SabertoothMotors:
    """Fits `vehicle.motors.Motors`. The driver cannot detect whether a Sabertooth is connected."""

    Settings = SabertoothSettings

    def __init__(self, settings: SabertoothSettings, *, clock: Callable[[], float] = time.monotonic) -> None:
        """Open the port and stop the motors. Raises MotorError if the port cannot be opened."""
        self.count = 2
        self.enabled = False
        self._settings = settings
        name = f"Sabertooth {settings.address}"
        self._controller = SerialController(name, settings.port, settings.baud, settings.timeout, clock)
        self.port = self._controller.port
        self._controller.open(self.disable)

    def enable(self) -> None:
        """Enable the motors. Raises MotorError unless `timeout_proven` is set."""
        if self.enabled:
            return
        self.prove()
        with self._controller.raise_errors():
            self.port.open()
            self.port.write(BAUDING + self._timeout() + self._drive((0.0, 0.0)))
        self._controller.timeout_sent()
        self.enabled = True

    def prove(self) -> None:
        """Raise MotorError unless `timeout_proven` is set."""
        if not self._settings.timeout_proven:
            raise self._controller.build_error(
                "its timeout cannot be read back: pull its signal wire with the wheels in the air, "
                "see them stop, then set timeout_proven = true"
            )

    def disable(self) -> None:
        """Stop both motors, ahead of all that waits to be sent. Raises MotorError if the port cannot send."""
        self.enabled = False
        with self._controller.raise_errors():
            self.port.open()
            self.port.discard_output()
            # At most two frames are damaged: the truncated one, and the next until the controller is synchronised.
            self.port.write(BAUDING + self._timeout() + self._drive((0.0, 0.0)) * REPEATS)

    def set(self, throttles: Sequence[float]) -> None:
        """Send a frame for each motor; no effect while disabled."""
        values = check_throttles(throttles, self.count)
        if not self.enabled:
            return
        with self._controller.tolerate_errors() as now:
            timeout = BAUDING + self._timeout() if self._controller.is_timeout_due(now) else b""
            self.port.write(timeout + self._drive(values))
            self._controller.error_budget.reset()

    def close(self) -> None:
        """Disable the motors, then close the port."""
        self._controller.close(self.disable)

    def _timeout(self) -> bytes:
        return self._packet(SET_TIMEOUT, self._controller.timeout_tenths)

    def _drive(self, throttles: Sequence[float]) -> bytes:
        return b"".join(
            self._packet(forward + (throttle < 0.0), round(abs(throttle) * FULL))
            for forward, throttle in zip(FORWARD, throttles, strict=True)
        )

    def _packet(self, command: int, value: int) -> bytes:
        address = self._settings.address
        return bytes([address, command, value, (address + command + value) & 0x7F])
