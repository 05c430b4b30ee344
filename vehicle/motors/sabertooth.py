"""Dimension Engineering Sabertooth (two motors) in packetized serial mode: one wire to it, none back.

It stops its motors when it has heard nothing for its serial timeout, which is off by default, is forgotten with its
power (user guide 2x12, command 14), and can be set but not read back. So this driver sets it at each enable and again
each second, and still does not enable a motor before a person has said that it works: pull the signal wire while the
wheels turn in the air, see them stop, and write `timeout_proven = true`.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Sequence
from typing import Annotated, Literal

import msgspec

from vehicle.motors import check_throttles
from vehicle.motors.serial_controller import SerialController, tenths
from vehicle.motors.settings import port_name, uart_pins

BAUDING = bytes([170])
"""First byte after power-up for models that measure the baud rate; others drop it."""
AHEAD = (0, 4)
"""Command of motor 1 and 2; one more is backwards."""
SET_TIMEOUT = 14
FULL = 127
REPEATS = 3
"""Nobody acknowledges a stop, so it is sent three times."""


class SabertoothSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One Sabertooth: motor 1 is the left one, motor 2 the right one."""

    port: str
    baud: Literal[2400, 9600, 19200, 38400] = 9600
    """9600 is the factory's; at 2400 a write to both motors takes 33 ms, longer than a control cycle."""
    address: Annotated[int, msgspec.Meta(ge=128, le=135)] = 128
    timeout: Annotated[float, msgspec.Meta(ge=0.1, le=0.5)] = 0.3
    """s of silence until the controller stops; steps of 0.1."""
    timeout_proven: bool = False
    """You have pulled the signal wire while the wheels turned in the air, and they stopped."""

    @property
    def taken(self) -> list[str]:
        """The port."""
        return [port_name(self.port)]

    @property
    def pins_nearby(self) -> tuple[int, ...]:
        """Where it may come out."""
        return uart_pins(self.port)


class SabertoothMotors:
    """Fits `vehicle.motors.Motors`. It cannot know whether a Sabertooth is there."""

    Settings = SabertoothSettings

    def __init__(self, settings: SabertoothSettings, *, clock: Callable[[], float] = time.monotonic) -> None:
        """Raises MotorError where the port cannot be opened."""
        self.count = 2
        self.enabled = False
        self._settings = settings
        self._controller = SerialController(f"Sabertooth {settings.address}", settings.port, settings.baud, clock)
        self.port = self._controller.port
        with contextlib.ExitStack() as opened:
            opened.callback(self.port.close)
            self.disable()
            opened.pop_all()

    def enable(self) -> None:
        """Raises MotorError unless the timeout was proven by hand."""
        if self.enabled:
            return
        self.prove()
        with self._controller.raise_errors():
            self.port.open()
            self.port.write(BAUDING + self._timeout() + self._drive((0.0, 0.0)))
        self._controller.timeout_sent()
        self.enabled = True

    def prove(self) -> None:
        """Raises MotorError unless the timeout was proven by hand."""
        if not self._settings.timeout_proven:
            raise self._controller.build_error(
                "its timeout cannot be read back: pull its signal wire with the wheels in the air, "
                "see them stop, then set timeout_proven = true"
            )

    def disable(self) -> None:
        """Stop both, ahead of all that still waits to be sent. Raises MotorError where the port does not take it."""
        self.enabled = False
        with self._controller.raise_errors():
            self.port.open()
            self.port.discard_output()
            # Two half frames at most: the one that was cut, and what follows until its end is found again.
            self.port.write(BAUDING + self._timeout() + self._drive((0.0, 0.0)) * REPEATS)

    def set(self, throttles: Sequence[float]) -> None:
        """A frame for each motor; nothing while disabled."""
        values = check_throttles(throttles, self.count)
        if not self.enabled:
            return
        with self._controller.tolerate_errors() as now:
            reminder = BAUDING + self._timeout() if self._controller.is_timeout_due(now) else b""
            self.port.write(reminder + self._drive(values))
            self._controller.error_budget.reset()

    def close(self) -> None:
        """As disabled, then the port is let go."""
        self._controller.close(self.disable)

    def _timeout(self) -> bytes:
        return self._packet(SET_TIMEOUT, tenths(self._settings.timeout))

    def _drive(self, throttles: Sequence[float]) -> bytes:
        return b"".join(
            self._packet(ahead + (throttle < 0.0), round(abs(throttle) * FULL))
            for ahead, throttle in zip(AHEAD, throttles, strict=True)
        )

    def _packet(self, command: int, value: int) -> bytes:
        address = self._settings.address
        return bytes([address, command, value, (address + command + value) & 0x7F])
