"""Messages by name, and the values of their fields: raw, as MAVLink defines them, without conversion of units."""

from __future__ import annotations

import re
from collections.abc import Callable
from operator import eq, ge, gt, le, lt, ne
from typing import Any

import msgspec

from dialects.enum_names import enum_names
from dialects.messages import MESSAGES, Message, field_value
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.nearest import describe_nearest

_CONDITION = re.compile(r"\s*(?P<field>[A-Za-z]\w*(?:\[\d+\])?)?\s*(?P<sign>>=|<=|==|!=|=|>|<)\s*(?P<value>.+?)\s*")
_SIGNS: dict[str, Callable[[Any, Any], bool]] = {
    ">": gt, "<": lt, ">=": ge, "<=": le, "==": eq, "=": eq, "!=": ne,
}  # fmt: skip
_INDEXED = re.compile(r"(?P<name>\w+)\[(?P<index>\d{1,3})\]")


class FieldPath(msgspec.Struct, frozen=True):
    """A field of a message, or one item of it."""

    name: str
    index: int | None = None

    def __str__(self) -> str:
        return self.name if self.index is None else f"{self.name}[{self.index}]"

    def read(self, message: Message) -> Any:
        """Return the value; None where an array is shorter."""
        value = field_value(message, self.name)
        if self.index is None:
            return value
        return value[self.index] if isinstance(value, list) and self.index < len(value) else None


class Condition(msgspec.Struct, frozen=True):
    """What a field is compared with."""

    field: FieldPath
    sign: str
    value: float | str

    def holds(self, message: Message) -> bool:
        """Return whether the message fulfils it. Numbers and texts are never equal, and never less or more."""
        found = self.field.read(message)
        if isinstance(self.value, str) != isinstance(found, str) or not isinstance(found, int | float | str):
            return self.sign == "!="
        return _SIGNS[self.sign](found, self.value)


def find_message(name: str) -> type[Message]:
    """Return the message of this name, in any case. Raises VerbError."""
    names = {kind.msgname: kind for kind in MESSAGES.values()}
    found = names.get(name.upper())
    if found is None:
        hint = describe_nearest(name.upper(), names) or ";"
        text = f"there is no message {name!r}{hint} Messages of ArduPilot alone: --dialect ardupilotmega.xml"
        raise VerbError(ExitCode.USAGE, text)
    return found


def find_field(kind: type[Message], text: str) -> FieldPath:
    """Return a field by its name, or one item as in "voltages[0]". Raises VerbError."""
    indexed = _INDEXED.fullmatch(text)
    name, index = (indexed["name"], int(indexed["index"])) if indexed else (text, None)
    if name not in kind.fieldnames:
        hint = describe_nearest(name, kind.fieldnames, every=True)
        raise VerbError(ExitCode.USAGE, f"{kind.msgname} has no field {name!r}{hint}")
    return FieldPath(name, index)


def parse_condition(text: str, kind: type[Message], field: FieldPath | None) -> Condition:
    """Return the condition of "field>0.5", or of ">0.5" for `field`. Raises VerbError."""
    found = _CONDITION.fullmatch(text)
    if found is None or (found["field"] is None and field is None):
        example = "'>0.5'" if field else f"'{kind.fieldnames[-1]}>0.5'"
        raise VerbError(ExitCode.USAGE, f"{text!r} is not a condition: write it as {example}")
    path = find_field(kind, found["field"]) if found["field"] else field
    assert path is not None
    return Condition(path, found["sign"], _parse_value(found["value"], kind, path))


def value_text(value: Any) -> str:
    """Return a value as text."""
    if isinstance(value, list):
        return " ".join(map(value_text, value))
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def _parse_value(text: str, kind: type[Message], path: FieldPath) -> float | str:
    named = {name: number for number, name in enum_names(kind.fieldenums_by_name.get(path.name, "")).items()}
    if text.upper() in named:
        return named[text.upper()]
    try:
        return int(text, 0)
    except ValueError:
        pass
    try:
        return float(text)
    except ValueError:
        return text.strip("'\"")
