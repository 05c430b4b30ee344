"""A range sensor that sends by itself on a serial port."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Protocol

from vehicle.motors.port import MotorPort
from vehicle.readings import Scan

WAIT = 0.5
"""s for a scan: that after which the sensor counts as lost."""


class Parser(Protocol):
    """Finds the frames of a sensor in bytes."""

    def feed(self, data: bytes) -> Scan | None:
        """Return the newest scan, None before a whole one."""


class SerialRanger:
    """Opens its port with the first sample, and again after an error: an adapter may be plugged in later."""

    def __init__(self, path: str, baud: int, parser: Parser, clock: Callable[[], float] = time.monotonic) -> None:
        self._port = MotorPort(path, baud)
        self._parser = parser
        self._clock = clock

    def sample(self) -> Scan:
        """Wait for a scan and return the newest one. Raises OSError."""
        self._port.open()
        end, received = self._clock() + WAIT, False
        while (left := end - self._clock()) > 0:
            data = self._port.read(left)
            received = received or bool(data)
            newest = self._parser.feed(data)
            if newest is not None:
                return self._drain(newest)
        why = "sends no valid frames: is this its port?" if received else "is silent; check its power and wiring"
        raise OSError(f"{self._port.path}: {why}")

    def close(self) -> None:
        """Close the port."""
        self._port.close()

    def _drain(self, newest: Scan) -> Scan:
        """Read what else waits: a thread that was late shall not fall behind."""
        while data := self._port.read():
            newest = self._parser.feed(data) or newest
        return newest
