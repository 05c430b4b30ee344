"""Fields of a message as texts: value, unit, and what the value means by the units and enums of the dialect."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from dialects.enum_names import enum_names, flag_names
from dialects.messages import ExtraMessage, Message, StatusText, SysStatus, decode_text
from dialects.printable import printable
from groundstation.views.messages import MessageField

MAX_TEXT = 200
"""Characters kept of a value."""
MAX_ITEMS = 24
"""Items of an array that are shown."""

UNITS: dict[str, tuple[float, str, int]] = {
    "mV": (1e-3, "V", 3), "cV": (1e-2, "V", 2), "mA": (1e-3, "A", 3), "cA": (1e-2, "A", 2), "mAh": (1e-3, "Ah", 3),
    "hJ": (1e2, "J", 0), "d%": (1e-1, "%", 1), "c%": (1e-2, "%", 2), "degE7": (1e-7, "deg", 7),
    "degE5": (1e-5, "deg", 5), "cdeg": (1e-2, "deg", 2), "ddeg": (1e-1, "deg", 1), "rad": (180 / math.pi, "deg", 2),
    "rad/s": (180 / math.pi, "deg/s", 2), "mrad/s": (0.18 / math.pi, "deg/s", 2), "cdeg/s": (1e-2, "deg/s", 2),
    "mm": (1e-3, "m", 3), "cm": (1e-2, "m", 2), "dm": (1e-1, "m", 1), "mm/s": (1e-3, "m/s", 3),
    "cm/s": (1e-2, "m/s", 2), "dm/s": (1e-1, "m/s", 1), "mG": (9.80665e-3, "m/s2", 3), "mgauss": (1e-3, "gauss", 3),
    "cdegC": (1e-2, "degC", 2), "ms": (1e-3, "s", 3), "us": (1e-6, "s", 6), "KiB": (1.024, "kB", 0),
}  # fmt: skip
"""Unit of a field (mavlink_types.xsd) -> factor, the unit that people use, and its decimals."""

HEALTH = "onboard_control_sensors_health"
JOINED = ("onboard_control_sensors_present", "onboard_control_sensors_enabled")
"""Fields of SYS_STATUS: the flags of all three are listed once, with the health."""


def build_fields(message: Message) -> tuple[MessageField, ...]:
    """Return the fields in the order of the definition."""
    return tuple(_build(message, name) for name in type(message).fieldnames)


def _build(message: Message, name: str) -> MessageField:
    kind = type(message)
    value = field_value(message, name)
    unit = kind.fieldunits_by_name.get(name, "")
    enum = kind.fieldenums_by_name.get(name, "")
    if isinstance(message, SysStatus) and name == HEALTH:
        return MessageField(name, _text(value), "", *_health(message))
    if enum and isinstance(value, int):
        if kind.fielddisplays_by_name.get(name) == "bitmask":
            flags = flag_names(enum, value)
            summary = f"{len(flags)} flags" if len(flags) > 1 else ""
            return MessageField(name, f"0x{value:x}", "", summary, () if name in JOINED else flags)
        return MessageField(name, str(value), "", enum_names(enum).get(value, f"not in {enum}"))
    return MessageField(name, _text(value), unit, _in_usual_unit(value, unit))


def field_value(message: Message, name: str) -> Any:
    """Return the value of a field of any message, also of one of a user's dialect."""
    if isinstance(message, ExtraMessage):
        return message.values[name]
    return decode_text(message) if isinstance(message, StatusText) and name == "text" else getattr(message, name)


def _health(message: SysStatus) -> tuple[str, tuple[str, ...]]:
    """Return a summary and one line for each sensor: marks for present, enabled and healthy, and its name.

    Bad ones come first, then those that are healthy, then those that are not enabled.
    """
    present, enabled = message.onboard_control_sensors_present, message.onboard_control_sensors_enabled
    bad = enabled & ~message.onboard_control_sensors_health
    lines: list[str] = []
    for bit, name in enum_names("MAV_SYS_STATUS_SENSOR").items():
        if (present | enabled) & bit:
            health = "✗" if bad & bit else "✓" if enabled & bit else "·"
            lines.append(f"{'✓' if present & bit else '·'}{'✓' if enabled & bit else '·'}{health} {name}")
    lines.sort(key=lambda line: "✗✓·".index(line[2]))
    count = bad.bit_count()
    return (f"{count} of {enabled.bit_count()} enabled not healthy" if count else "all enabled healthy"), tuple(lines)


def _in_usual_unit(value: Any, unit: str) -> str:
    if unit not in UNITS or not isinstance(value, (int, float)) or not math.isfinite(value):
        return ""
    factor, usual, decimals = UNITS[unit]
    return f"{value * factor:.{decimals}f} {usual}"


def _text(value: Any) -> str:
    """Return a value as text for the screen: a text from the link without control characters."""
    if isinstance(value, (list, tuple)):
        return " ".join(_items(value))[:MAX_TEXT]
    if isinstance(value, float):
        return f"{value:.7g}"
    if isinstance(value, bytes):
        value = value.split(b"\0", 1)[0].decode("utf-8", "replace")
    return printable(str(value))[:MAX_TEXT]


def _items(values: Sequence[Any]) -> Iterator[str]:
    yield from (_text(each) for each in values[:MAX_ITEMS])
    if len(values) > MAX_ITEMS:
        yield f"... {len(values)} values"
