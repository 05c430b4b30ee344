"""Motor drivers: the Motors protocol, its errors and the checks that every driver makes.

To add a driver, write a class that fits `Motors`, add one row to DRIVERS in vehicle/motors/drivers.py, and test the
class with tests/vehicle/motors/contract.py. A driver outside this package needs no row: name it "module:Class".
A driver with settings names their type `Settings` (a msgspec.Struct) and is built as `Class(settings)`.

To add or change:
- a known car: `vehicle/motors/drivers.py`: a row in `DRIVERS` with `profile` and `params`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol


class MotorError(Exception):
    """A motor driver cannot do what was requested. The text is one line."""


class StopPressedError(MotorError):
    """The hardware emergency stop is open, or was open since the motors were enabled. It is not a driver fault."""


class UnknownDriverError(MotorError):
    """The driver does not exist: a user error, not a hardware fault."""


class MotorSettingsError(UnknownDriverError):
    """A setting does not exist or has an invalid value: a user error, too."""


class Motors(Protocol):
    """All motors of one vehicle as one object, so that they are stopped together.

    The rules, which the shared contract test checks:
    neutral and disabled after construction; `enable` starts from neutral whatever was set before; `set` while disabled
    turns nothing; a rejected `set` changes no motor; `close` sets neutral, then disables, and may be called twice.
    """

    @property
    def count(self) -> int:
        """Number of motors; the length of `throttles`."""

    def enable(self) -> None:
        """Let the motors turn, from neutral. Raises MotorError."""

    def disable(self) -> None:
        """Remove the power at once, from any state. Raises MotorError."""

    def set(self, throttles: Sequence[float]) -> None:
        """Set each motor's throttle, -1 (full reverse) to 1 (full forward).

        Raises MotorError if the count is wrong, a value is NaN or out of range, or the hardware does not respond.
        """

    def close(self) -> None:
        """Set neutral, disable the motors, then release the hardware."""


def estop_reader(motors: Motors) -> Callable[[], str | None]:
    """Return the function that reads the hardware emergency stop of `motors`.

    The function returns why the stop is active, or None while its contact is closed. It may raise MotorError. The
    control loop calls it in each cycle, with and without power. A driver with a stop has a method `stop_pressed`.
    """
    reader: Callable[[], str | None] = getattr(motors, "stop_pressed", _no_estop)
    return reader


def _no_estop() -> None:
    """Return None: the driver has no emergency stop."""


def arming_check(motors: Motors) -> Callable[[], None]:
    """Return the function that raises MotorError while `motors` must not be armed.

    An example is a controller whose serial timeout is not confirmed. The function is called without power, at the start
    and after each failure. A driver with such a check has a method `prove`.
    """
    check: Callable[[], None] = getattr(motors, "prove", _nothing_to_prove)
    return check


def _nothing_to_prove() -> None:
    """Return: the driver has nothing to confirm."""


def check_throttles(throttles: Sequence[float], count: int) -> tuple[float, ...]:
    """Return `throttles` as a tuple after checking their number and range. Raises MotorError.

    Every driver calls this first in `set`: the motor gate of the rover limits the values already, but a driver must be
    safe with any caller.
    """
    if len(throttles) != count:
        raise MotorError(f"{len(throttles)} throttles for {count} motors")
    for throttle in throttles:
        if not -1.0 <= throttle <= 1.0:  # also rejects NaN
            raise MotorError(f"throttle {throttle} is outside -1..1")
    return tuple(throttles)
