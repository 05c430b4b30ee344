"""A record of what the motors get, for tests and benchmarks that look at a vehicle from outside; it wraps any driver.

One line for each change: `<clock ns> <throttle> <throttle> ...`, written with one unbuffered write, so that a reader in
another process sees it at once and a killed process loses nothing.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence

from vehicle.motors import Motors


class MotorLog:
    """A file that takes lines until it cannot: a full disk must not stop a rover that drives."""

    def __init__(self, path: str) -> None:
        """Open `path` to append. Raises OSError."""
        # Not blocking: it may be a pipe, and whoever reads that must not be able to hold up the motors.
        flags = os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC | os.O_NONBLOCK
        self._descriptor = os.open(path, flags, 0o644)
        self.fault: OSError | None = None
        """Why lines are missing at the end, or None."""

    def write(self, line: str) -> None:
        """Append one line; after the first failure nothing more."""
        if self.fault is None:
            try:
                os.write(self._descriptor, line.encode())
            except OSError as error:
                self.fault = error


class LoggedMotors:
    """Motors that tell of each change. `clock` gives ns of a clock that other processes share (CLOCK_MONOTONIC)."""

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
        """Disable the motors; they stand, so that is written."""
        self._motors.disable()
        self._enabled = False
        self._write_change(self._neutral)

    def set(self, throttles: Sequence[float]) -> None:
        """Set the motors; written once they have it, and only where they are enabled: else nothing turns."""
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
