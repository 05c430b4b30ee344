"""What turns the wheels: the Motors protocol, the table of drivers and the checks each makes; no driver itself.

To add a driver, write a class that fits `Motors`, add one line to DRIVERS, and test it with
tests/vehicle/motors/contract.py.
A driver of your own needs no line: name it "module:Class".
"""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from importlib import import_module
from typing import Protocol

DRIVERS: dict[str, str] = {
    "simulated": "vehicle.motors.simulated:SimulatedMotors",
}
"""Name -> "module:Class". Imported only when asked for: a driver's library is installed only where its hardware is."""


class MotorError(Exception):
    """A motor driver cannot do what was asked. The text is one clear line."""


class UnknownDriverError(MotorError):
    """There is no such driver: the user's mistake, not a fault of the hardware."""


class Motors(Protocol):
    """All motors of one vehicle, as one thing, so that they are stopped together.

    The rules, which the shared contract test checks:
    silent when made (neutral and disabled); `enable` starts from neutral whatever was set before; what is set while
    disabled turns nothing; a refused `set` changes no motor; `close` is neutral, then disabled, and may come twice.
    """

    @property
    def count(self) -> int:
        """How many motors; the length of `throttles`."""

    def enable(self) -> None:
        """Let the motors turn, from neutral. Raises MotorError."""

    def disable(self) -> None:
        """Take the power away at once, from any state. Raises MotorError."""

    def set(self, throttles: Sequence[float]) -> None:
        """Each motor's throttle, -1 (full reverse) to 1 (full ahead).

        Raises MotorError where the count is wrong, a value is not a number or outside, or the hardware does not answer.
        """

    def close(self) -> None:
        """Neutral, then disabled, then let go of the hardware."""


def checked(throttles: Sequence[float], count: int) -> tuple[float, ...]:
    """`throttles` as a tuple, once it is certain that every one may go to a motor. Raises MotorError.

    Every driver calls it first in `set`: the last gate of the rover already holds the limits, but a driver must be
    safe with any caller.
    """
    if len(throttles) != count:
        raise MotorError(f"{len(throttles)} throttles for {count} motors")
    for throttle in throttles:
        if not -1.0 <= throttle <= 1.0:  # also false for NaN
            raise MotorError(f"throttle {throttle} is outside -1..1")
    return tuple(throttles)


def open_motors(name: str) -> Motors:
    """The motors of the driver `name`: a name from DRIVERS, or "module:Class".

    Raises UnknownDriverError for a name that leads nowhere and MotorError where the driver cannot start.
    """
    motors: Motors = _driver_class(name)()
    missing = [verb for verb in ("count", "enable", "disable", "set", "close") if not hasattr(motors, verb)]
    if missing:
        raise UnknownDriverError(f"motor driver {name!r} is none: it lacks {', '.join(missing)}")
    return motors


def _driver_class(name: str) -> type[Motors]:
    target = DRIVERS.get(name, name)
    module_name, colon, class_name = target.partition(":")
    if not (colon and module_name and class_name):
        raise UnknownDriverError(_unknown(name))
    try:
        driver: type[Motors] = getattr(import_module(module_name), class_name)
    except ImportError as error:
        raise UnknownDriverError(f"motor driver {name!r} cannot be loaded: {error}") from error
    except AttributeError as error:
        raise UnknownDriverError(f"motor driver {name!r}: module {module_name} has no {class_name!r}") from error
    return driver


def _unknown(name: str) -> str:
    near = difflib.get_close_matches(name, DRIVERS, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(DRIVERS)}; or your own as module:Class"
    return f"unknown motor driver {name!r}; {hint}"
