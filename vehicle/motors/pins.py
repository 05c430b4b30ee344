"""gpiozero, imported in a way that suits a daemon, with its errors translated to MotorError."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from importlib import import_module

from link.runtime.install_hint import install_command
from vehicle.hardware.error_text import format_error
from vehicle.motors import MotorError


def _import_lgpio() -> tuple[type[BaseException], ...]:
    """Import lgpio outside the working directory; return its error class, if lgpio is installed.

    During import, lgpio changes to the directory $LG_WD and creates a pipe there, which fails in a service with a
    read-only file system (seen with lgpio 0.2.2.0). The names of pipe and directory are not needed after that.
    """
    home, configured = os.getcwd(), os.environ.get("LG_WD")
    with tempfile.TemporaryDirectory(prefix="lgpio-") as directory:
        os.environ["LG_WD"] = configured or directory
        try:
            return (import_module("lgpio").error,)
        except ImportError:
            return ()
        finally:
            os.chdir(home)
            if configured is None:
                del os.environ["LG_WD"]


_lgpio_errors = _import_lgpio()
# Skip gpiozero's search through four libraries: two of them are unmaintained, one has no PWM, and the reason why lgpio
# does not work would be lost.
os.environ.setdefault("GPIOZERO_PIN_FACTORY", "lgpio")

try:
    from gpiozero import (
        DigitalInputDevice,
        DigitalOutputDevice,
        DistanceSensor,
        Motor,
        PhaseEnableMotor,
        PWMOutputDevice,
        RotaryEncoder,
    )
    from gpiozero.exc import GPIOZeroError
except ImportError as error:
    raise MotorError(f"{error}; install it: {install_command('pi')}") from error

FAULTS: tuple[type[BaseException], ...] = (GPIOZeroError, OSError, ImportError, *_lgpio_errors)

__all__ = [
    "DigitalInputDevice",
    "DigitalOutputDevice",
    "DistanceSensor",
    "Motor",
    "PWMOutputDevice",
    "PhaseEnableMotor",
    "RotaryEncoder",
    "translated",
]


HINTS = {
    "unable to locate Pi revision": "is this a Raspberry Pi? Elsewhere use simulated pins (docs/pi.md, Without a Pi)",
    "No module named 'lgpio'": f"install it: {install_command('pi')}",
    "can not open gpiochip": "add yourself to its group: sudo usermod -aG gpio $USER, log in again",
}
"""Start of an error text of gpiozero or lgpio -> what to do."""


def _describe(error: BaseException) -> str:
    text = format_error(error)
    return "; ".join([text, *(hint for start, hint in HINTS.items() if text.startswith(start))])


@contextlib.contextmanager
def translated(what: str) -> Iterator[None]:
    """Turn the errors of pins into a MotorError, whose text starts with `what`."""
    try:
        yield
    except FAULTS as error:
        raise MotorError(f"{what}: {_describe(error)}") from error
