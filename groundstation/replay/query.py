"""What `/` searches in a log: a text of the events, the next message of a name, or a condition on a field."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable
from typing import Any

import msgspec

from dialects.enums import ModeFlag
from dialects.kinds import find_kind
from dialects.messages import MESSAGES, Heartbeat, Message

_COMPARE: dict[str, Callable[[Any, Any], bool]] = {
    "==": operator.eq, "!=": operator.ne, "<=": operator.le, ">=": operator.ge, "<": operator.lt, ">": operator.gt,
    "=": operator.eq,
}  # fmt: skip
_CONDITION = re.compile(r"\s*([A-Za-z]\w*(?:\.\w+)?)\s*(==|!=|<=|>=|<|>|=)\s*(\S.*?)\s*")

ALIASES: dict[str, tuple[str, str, float]] = {
    "batt": ("SYS_STATUS", "voltage_battery", 0.001),
    "current": ("SYS_STATUS", "current_battery", 0.01),
    "speed": ("VFR_HUD", "groundspeed", 1.0),
    "throttle": ("VFR_HUD", "throttle", 1.0),
    "heading": ("VFR_HUD", "heading", 1.0),
    "sats": ("GPS_RAW_INT", "satellites_visible", 1.0),
    "fix": ("GPS_RAW_INT", "fix_type", 1.0),
}
"""Short name -> message, field and factor to the unit that people use."""


class QueryError(ValueError):
    """Not something that can be searched; the message is one line for the user."""


class Query(msgspec.Struct, frozen=True):
    """What is searched: a text in the events, or messages of one id."""

    text: str
    message_id: int | None = None
    """None: the text of events is searched."""
    holds: Callable[[Any], bool] | None = None
    """The condition; None: any message of this id."""


def parse_query(text: str) -> Query:
    """Return what a text searches. Raises QueryError."""
    text = text.strip()
    if not text:
        raise QueryError("type a text, a message such as HOME_POSITION, or a condition such as batt<11.5")
    if (condition := _CONDITION.fullmatch(text)) is not None:
        return _parse_condition(text, *condition.groups())
    found = _find_message(text) if text.isupper() else None
    return Query(text, found.id) if found is not None else Query(text)


def _find_message(name: str) -> type[Message] | None:
    return next((kind for kind in MESSAGES.values() if kind.msgname == name.upper()), None)


def _parse_condition(text: str, name: str, sign: str, value: str) -> Query:
    compare = _COMPARE[sign]
    if name.lower() == "mode":
        wanted = value.upper()
        return Query(text, Heartbeat.id, lambda beat: compare(_mode_of(beat), wanted))
    number = _number(value)
    if name.lower() == "armed":
        return Query(text, Heartbeat.id, lambda beat: compare(bool(beat.base_mode & ModeFlag.ARMED), bool(number)))
    message, field, factor = ALIASES.get(name.lower(), (*name.partition(".")[::2], 1.0))
    kind = _find_message(message)
    if kind is None or field not in kind.fieldnames:
        raise QueryError(f"{name!r} is not known: use MESSAGE.field, mode, armed, {', '.join(ALIASES)}")
    return Query(text, kind.id, lambda each: _compare(each, field, factor, compare, number))


def _mode_of(beat: Any) -> str:
    return find_kind(beat.autopilot, beat.type).mode_name(beat.custom_mode)


def _number(value: str) -> float:
    try:
        number = float(value)
    except ValueError:
        raise QueryError(f"{value!r} is not a number") from None
    if not math.isfinite(number):
        raise QueryError(f"{value!r} is not a number")
    return number


def _compare(message: Message, field: str, factor: float, compare: Callable[[Any, Any], bool], number: float) -> bool:
    found = getattr(message, field, None)
    if isinstance(found, (list, tuple)):
        return any(isinstance(each, (int, float)) and compare(each * factor, number) for each in found)
    return isinstance(found, (int, float)) and compare(found * factor, number)
