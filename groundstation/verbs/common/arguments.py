"""Arguments of verbs: what argparse turns words into. A mistake is one line."""

from __future__ import annotations

import argparse
import math
import re
from typing import Any

from link.endpoint import FLEET_NAME
from link.services.param.float32 import is_float32

Argument = tuple[str, dict[str, Any]]
"""Name and settings for argparse."""
FILE: Argument = ("file", {"metavar": "FILE"})
YES: Argument = ("--yes", {"action": "store_true", "help": "overwrite the file"})

LONGEST = 86_400.0
"""s; a day."""
SLOWEST, FASTEST = 0.001, 200
"""Hz; our vehicle takes 200 demands a second, and an interval has 31 bits of us."""

FASTEST_SPEED = 100.0
"""m/s; our vehicle takes no more."""

LONGEST_HOLD = 9.0
"""s between two lines while a drive key is held. Our vehicle stops 10 s after the last key (OPR_TIMEOUT), because a key
that nobody operates any more must not drive it; a script says that it goes on by another line."""


def number(text: str) -> float:
    """Parse a value that a parameter can have. Raises ArgumentTypeError."""
    try:
        value = float(int(text, 16)) if text.lower().startswith("0x") else float(text)
    except (ValueError, OverflowError):
        value = math.nan
    if not is_float32(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number that a parameter can have")
    return value


def finite(text: str) -> float:
    """Parse a number. Raises ArgumentTypeError for NaN and infinity."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number")
    return value


def seconds(text: str) -> float:
    """Parse a duration in s. Raises ArgumentTypeError."""
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 < value <= LONGEST:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of seconds above 0")
    return value


def system_id(text: str) -> int:
    """Parse a MAVLink system id. Raises ArgumentTypeError."""
    if not (text.isascii() and text.isdecimal() and len(text) <= 3 and 1 <= int(text) <= 255):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 1 to 255")
    return int(text)


def vehicle_id(text: str) -> int | str:
    """Parse a system id, or a name as all screens and verbs print it. Raises ArgumentTypeError.

    Returns the system id, also of a name that ends with it as "Rover 1", or the name of a vehicle in its fleet.
    """
    try:
        return system_id(text.rpartition(" ")[2])
    except argparse.ArgumentTypeError:
        if re.fullmatch(FLEET_NAME, text) and not text.isdecimal():
            return text
        known = "nor a name as 'Rover 1', or as 'rover1' in a fleet"
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 1 to 255, {known}") from None


def is_chosen(wanted: int | str | None, system: int, fleet_name: str) -> bool:
    """Return whether --vehicle names this vehicle; None: it names none, and any one will do."""
    return wanted is None or wanted == (fleet_name if isinstance(wanted, str) else system)


def float32(text: str) -> float:
    """Parse a parameter of a command; NaN means "not used". Raises ArgumentTypeError."""
    try:
        value = float(int(text, 16)) if text.lower().startswith("0x") else float(text)
    except (ValueError, OverflowError):
        value = math.inf
    if not (math.isnan(value) or is_float32(value)):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number")
    return value


def rate(text: str) -> float:
    """Parse a rate in Hz. Raises ArgumentTypeError."""
    value = rate_or_none(text)
    if value == 0:
        raise argparse.ArgumentTypeError("a rate of 0 sends nothing")
    return value


def rate_or_none(text: str) -> float:
    """Parse a rate in Hz, or 0. Raises ArgumentTypeError."""
    value = finite(text)
    if value and not SLOWEST <= value <= FASTEST:
        raise argparse.ArgumentTypeError(f"{text!r} is not a rate from {SLOWEST} to {FASTEST} Hz")
    return value


def metres_per_second(text: str) -> float:
    """Parse a speed. Raises ArgumentTypeError."""
    value = finite(text)
    if not 0 < value <= FASTEST_SPEED:
        raise argparse.ArgumentTypeError(f"{text!r} is not a speed above 0 and up to {FASTEST_SPEED:g} m/s")
    return value


def count(text: str) -> int:
    """Parse how often. Raises ArgumentTypeError."""
    if not (text.isascii() and text.isdecimal() and len(text) <= 6 and int(text) >= 1):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 1 to 999999")
    return int(text)
