"""The wire to a motor controller with a serial timeout of its own: port, patience, and when it was last reminded."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

from vehicle.motors import MotorError
from vehicle.motors.error_budget import ErrorBudget
from vehicle.motors.port import SerialPort

TIMEOUT_RESEND_PERIOD = 1.0
"""s between settings of the timeout while driving: a controller that lost its power for a moment has forgotten it."""


def tenths(timeout: float) -> int:
    """S as the controllers count them, rounded down."""
    return int(timeout * 10 + 1e-9)


class SerialController:
    """What is said of it has the controller's name."""

    def __init__(self, name: str, path: str, baud: int, clock: Callable[[], float]) -> None:
        self.port = SerialPort(path, baud)
        self.error_budget = ErrorBudget()
        self._name = f"{name} on {path}"
        self._clock = clock
        self._reminded = 0.0

    def close(self, silence: Callable[[], None]) -> None:
        """The motors stand, then the port is let go, also where they do not. Raises MotorError."""
        if self.port.is_open:
            with contextlib.ExitStack() as steps:
                steps.callback(self.port.close)
                silence()

    def timeout_sent(self) -> None:
        """The timeout was set just now, and all is well."""
        self.error_budget.reset()
        self._reminded = self._clock()

    def is_timeout_due(self, now: float) -> bool:
        """The timeout is to be set again; asked once, it counts as done."""
        due = now - self._reminded >= TIMEOUT_RESEND_PERIOD
        self._reminded = now if due else self._reminded
        return due

    @contextlib.contextmanager
    def tolerate_errors(self) -> Iterator[float]:
        """Gives the time. A port that does not take a frame is put up with for a moment; then raises MotorError."""
        now = self._clock()
        try:
            yield now
        except OSError as error:
            self.error_budget.add_failure(self.describe(str(error)), now)

    @contextlib.contextmanager
    def raise_errors(self) -> Iterator[None]:
        """Raises MotorError where the port does not take what is written."""
        try:
            yield
        except OSError as error:
            raise self.build_error(str(error)) from error

    def build_error(self, reason: str) -> MotorError:
        """To be raised."""
        return MotorError(self.describe(reason))

    def describe(self, reason: str) -> str:
        """One line."""
        return f"{self._name}: {reason}"
