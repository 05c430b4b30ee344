"""A log of the motor outputs, for tests and benchmarks that observe a vehicle from outside; it wraps any driver.

Each change is one line, `<clock ns> <throttle> <throttle> ...`, in one unbuffered write, so that another process reads
it at once and a killed process loses nothing.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence

from link.runtime.whole_file import PRIVATE
from vehicle.motors import Motors


class MotorLog:
    """A file to which lines are appended until a write fails: a full disk must not stop a driving rover."""

    def __init__(self, path: str) -> None:
        """Open `path` to append. Raises OSError."""
        # Non-blocking: the file may be a pipe, whose reader must not be able to block the motors.
        flags = os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC | os.O_NONBLOCK
        self._descriptor = os.open(path, flags, PRIVATE)
        self.fault: OSError | None = None
        """The first failed write, or None."""

    def write(self, line: str) -> None:
        """Append one line; no effect after the first failure."""
        if self.fault is None:
            try:
                os.write(self._descriptor, line.encode())
            except OSError as error:
                self.fault = error


class LoggedMotors:
    """Motors that log each change. `clock` returns ns of a clock that other processes share (CLOCK_MONOTONIC)."""

    def __init__(self, motors: Motors, write: Callable[[str], None], clock: Callable[[], int]) -> None:
        self.count = motors.count
        self._motors = motors
        self._write = write
        self._clock = clock
        self._enabled = False
        self._logged = self._neutral = (0.0,) * motors.count

    def enable(self) -> None:
        """Enable the motors."""
        self._motors.enable()
        self._enabled = True

    def disable(self) -> None:
        """Disable the motors, and log neutral."""
        self._motors.disable()
        self._enabled = False
        self._write_change(self._neutral)

    def set(self, throttles: Sequence[float]) -> None:
        """Set the motors, then log the throttles if the motors are enabled."""
        self._motors.set(throttles)
        if self._enabled:
            self._write_change(tuple(throttles))

    def close(self) -> None:
        """Close the motors."""
        self._motors.close()
        self._enabled = False
        self._write_change(self._neutral)

    def _write_change(self, throttles: tuple[float, ...]) -> None:
        if throttles != self._logged:
            self._logged = throttles
            values = " ".join(f"{throttle:.4f}" for throttle in throttles)
            self._write(f"{self._clock()} {values}\n")
