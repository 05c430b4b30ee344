"""gpiozero, imported in the one way that suits a daemon, and its faults as MotorError; no device itself."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from importlib import import_module

from vehicle.hardware.error_text import format_error
from vehicle.hardware.install_hints import INSTALL_HINT
from vehicle.motors import MotorError


def _import_lgpio() -> tuple[type[BaseException], ...]:
    """Import lgpio away from the working directory; its error class, where it is installed.

    At import lgpio changes into $LG_WD, creates a pipe there and fails where it may not, as in a service with a
    read-only system (seen with lgpio 0.2.2.0). Pipe and directory are not needed by name once it is open.
    """
    home, wish = os.getcwd(), os.environ.get("LG_WD")
    with tempfile.TemporaryDirectory(prefix="lgpio-") as directory:
        os.environ["LG_WD"] = wish or directory
        try:
            return (import_module("lgpio").error,)
        except ImportError:
            return ()
        finally:
            os.chdir(home)
            if wish is None:
                del os.environ["LG_WD"]


_lgpio_errors = _import_lgpio()
# Not gpiozero's search through four libraries: two of them are dead, one has no PWM, and the reason why lgpio did not
# work would be lost.
os.environ.setdefault("GPIOZERO_PIN_FACTORY", "lgpio")

try:
    from gpiozero import DigitalInputDevice, DigitalOutputDevice, Motor, PhaseEnableMotor, RotaryEncoder
    from gpiozero.exc import GPIOZeroError
except ImportError as error:
    raise MotorError(f"{error}; {INSTALL_HINT}") from error

FAULTS: tuple[type[BaseException], ...] = (GPIOZeroError, OSError, ImportError, *_lgpio_errors)

__all__ = ["DigitalInputDevice", "DigitalOutputDevice", "Motor", "PhaseEnableMotor", "RotaryEncoder", "translated"]


HINTS = {
    "unable to locate Pi revision": "is this a Raspberry Pi? Elsewhere simulated pins do (docs/pi.md, Without a Pi)",
    "No module named 'lgpio'": INSTALL_HINT,
    "can not open gpiochip": "add yourself to its group: sudo usermod -aG gpio $USER, log in again",
}
"""What gpiozero and lgpio say -> what to do."""


def _in_words(error: BaseException) -> str:
    words = format_error(error)
    return "; ".join([words, *(hint for start, hint in HINTS.items() if words.startswith(start))])


@contextlib.contextmanager
def translated(doing: str) -> Iterator[None]:
    """Whatever a pin raises meanwhile is a MotorError. `doing` begins its text."""
    try:
        yield
    except FAULTS as error:
        raise MotorError(f"{doing}: {_in_words(error)}") from error
