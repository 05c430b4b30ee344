"""What can be said of a value before it is written: numbers that cannot be sent, ranges, lists, names of values."""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import Enum

import msgspec

from groundstation.ui.params.edit.reasons import is_risky
from groundstation.views.params import ParamInfo
from link.services.param.float32 import is_float32, shortest_float32, value_text

INTEGERS = {
    "UINT8": (0, 0xFF), "INT8": (-0x80, 0x7F), "UINT16": (0, 0xFFFF), "INT16": (-0x8000, 0x7FFF),
    "UINT32": (0, 0xFFFF_FFFF), "INT32": (-0x8000_0000, 0x7FFF_FFFF),
}  # fmt: skip
"""Types of whole numbers, and what they hold."""


class Level(Enum):
    """What a check says."""

    UNKNOWN = ""
    GOOD = "✓"
    WARNING = "!"


class ValueCheck(msgspec.Struct, frozen=True):
    """A check of a value, as it is shown."""

    level: Level
    text: str
    limits: str = ""
    """The range that was checked."""

    @property
    def shown(self) -> str:
        """The text with its range and its mark."""
        return " ".join(part for part in (self.text, self.limits, self.level.value) if part)

    def fitted(self, width: int) -> str:
        """Return the text with its mark; with the range only if that is not cut."""
        return self.shown if len(self.shown) <= width else f"{self.text} {self.level.value}".rstrip()


def check_value(info: ParamInfo | None, value: float) -> ValueCheck:
    """Check against what the texts say. Ranges of autopilots are not always right: outside is only a warning."""
    if info is None:
        return ValueCheck(Level.UNKNOWN, "")
    if info.read_only:
        return ValueCheck(Level.WARNING, "read-only")
    if info.values:
        listed = any(each == value for each, _ in info.values)
        return ValueCheck(Level.GOOD, "in its list") if listed else ValueCheck(Level.WARNING, "not in its list")
    if info.bits:
        return _check_bits(info, value)
    return _check_range(info, value)


def _check_bits(info: ParamInfo, value: float) -> ValueCheck:
    known = sum(1 << bit for bit, _ in info.bits)
    if value.is_integer() and (value < 0 or not int(value) & ~known):
        return ValueCheck(Level.GOOD, "known bits")
    return ValueCheck(Level.WARNING, "unknown bits")


def _check_range(info: ParamInfo, value: float) -> ValueCheck:
    if info.low is None and info.high is None:
        return ValueCheck(Level.UNKNOWN, "no range known")
    below = info.low is not None and value < shortest_float32(info.low)
    above = info.high is not None and value > shortest_float32(info.high)
    if below or above:
        return ValueCheck(Level.WARNING, "outside", range_text(info))
    return ValueCheck(Level.GOOD, "in range", range_text(info))


def range_text(info: ParamInfo) -> str:
    """Return the range, "--" at an end that is not known."""
    low, high = ("--" if end is None else value_text(end) for end in (info.low, info.high))
    return f"{low} … {high}"


def meaning_of(info: ParamInfo | None, value: float) -> str:
    """Return the name of a value, or of its bits; empty where it has none."""
    if info is None:
        return ""
    if info.values:
        return next((name for each, name in info.values if each == value), "")
    if info.bits and value.is_integer() and value >= 0:
        return ", ".join(name for bit, name in info.bits if int(value) >> bit & 1)
    return ""


def needs_care(info: ParamInfo | None, name: str) -> bool:
    """Return whether a change while armed may move or no longer stop the vehicle."""
    return is_risky(name) or (info is not None and info.not_armed)


def parse_number(text: str, name: str, kind: str) -> float | str:
    """Return a typed number as the float32 that is sent, or what is wrong with it. 0x begins a hexadecimal one."""
    try:
        value = float(int(text, 16)) if text.lower().startswith(("0x", "-0x")) else float(text)
    except (ValueError, OverflowError):
        return f"{text!r} is not a number"
    if not math.isfinite(value) or not is_float32(value):
        return f"{text!r} cannot be set"
    if kind in INTEGERS:
        return _whole(value, name, kind)
    return shortest_float32(value)


def is_rounded(text: str, value: float) -> bool:
    """Return whether a typed number is sent as another one, the nearest float32."""
    try:
        return float(text) != value
    except ValueError:  # hexadecimal, or a name
        return False


def _whole(value: float, name: str, kind: str) -> float | str:
    low, high = INTEGERS[kind]
    if not value.is_integer():
        return f"{name} is {kind}: whole numbers only"
    return value if low <= value <= high else f"{name} is {kind}: {low} to {high}"


def matching(choices: Sequence[tuple[float, str]], text: str) -> list[tuple[float, str]]:
    """Return the choices in whose name the letters of a text come in this order, whole words first."""
    wanted = text.lower().strip()
    if not wanted:
        return list(choices)
    parts = [each for each in choices if wanted in each[1].lower()]
    return parts + [each for each in choices if each not in parts and _in_order(wanted, each[1].lower())]


def _in_order(letters: str, text: str) -> bool:
    rest = iter(text)
    return all(letter in rest for letter in letters if letter != " ")
