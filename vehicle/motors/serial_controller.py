"""What controllers on a serial port share: their port, their serial timeout and how long errors are tolerated."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

import msgspec

from vehicle.motors import MotorError
from vehicle.motors.error_budget import ErrorBudget
from vehicle.motors.port import MotorPort
from vehicle.motors.settings import port_name, uart_pins

TIMEOUT_RESEND_PERIOD = 1.0
"""s between settings of the timeout while driving: a controller that lost its power briefly has lost the setting."""


class SerialSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The port of a controller."""

    port: str
    """/dev/serial0, /dev/ttyACM0, or better a name from /dev/serial/by-id."""

    @property
    def taken(self) -> list[str]:
        """The port."""
        return [port_name(self.port)]

    @property
    def pins_nearby(self) -> tuple[int, ...]:
        """Pins that the port may use."""
        return uart_pins(self.port)


class SerialController:
    """A controller on a serial port that stops its motors after a timeout without frames."""

    def __init__(self, name: str, path: str, baud: int, timeout: float, clock: Callable[[], float]) -> None:
        """`name` starts the error texts; `timeout` is the controller's, in s."""
        self.port = MotorPort(path, baud)
        self.timeout_tenths = int(timeout * 10 + 1e-9)
        """The timeout in the unit of the controllers, 0.1 s, rounded down."""
        self.error_budget = ErrorBudget()
        self._name = f"{name} on {path}"
        self._clock = clock
        self._timeout_sent_at = 0.0

    def open(self, stop: Callable[[], None]) -> None:
        """Call `stop`, which opens the port and stops the motors; close the port on an error. Raises MotorError."""
        with contextlib.ExitStack() as opened:
            opened.callback(self.port.close)
            stop()
            opened.pop_all()

    def close(self, stop: Callable[[], None]) -> None:
        """Call `stop`, then close the port, even if stopping fails. Raises MotorError."""
        if self.port.is_open:
            with contextlib.ExitStack() as steps:
                steps.callback(self.port.close)
                stop()

    def timeout_sent(self) -> None:
        """Record that the timeout was set successfully just now."""
        self.error_budget.reset()
        self._timeout_sent_at = self._clock()

    def is_timeout_due(self, now: float) -> bool:
        """Return whether the timeout must be set again, and count it as set."""
        due = now - self._timeout_sent_at >= TIMEOUT_RESEND_PERIOD
        self._timeout_sent_at = now if due else self._timeout_sent_at
        return due

    @contextlib.contextmanager
    def tolerate_errors(self) -> Iterator[float]:
        """Yield the time; count an OSError against the error budget. Raises MotorError when that is exhausted."""
        now = self._clock()
        try:
            yield now
        except OSError as error:
            self.error_budget.add_failure(self.describe(str(error)), now)

    @contextlib.contextmanager
    def raise_errors(self) -> Iterator[None]:
        """Turn an OSError of the port into a MotorError."""
        try:
            yield
        except OSError as error:
            raise self.build_error(str(error)) from error

    def build_error(self, reason: str) -> MotorError:
        """Return an error that names the controller."""
        return MotorError(self.describe(reason))

    def describe(self, reason: str) -> str:
        """Return `reason` after the name of the controller, one line."""
        return f"{self._name}: {reason}"
