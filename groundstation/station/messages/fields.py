"""Numeric fields of messages: reading their values in usual units, and finding them by name."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator

from dialects.enum_names import enum_names
from dialects.messages import Message
from groundstation.station.messages.fuzzy import match_score
from groundstation.station.messages.message_fields import UNITS, field_value
from groundstation.views.charts import FieldId, FieldInfo

Reader = Callable[[Message], float | None]
"""Returns the value of a field, None where the message says that it is not known."""

DECIMALS = 2
"""Of values whose unit has none in UNITS."""

_UNKNOWN = {
    "uint16_t": 0xFFFF, "int16_t": 0x7FFF, "uint32_t": 0xFFFFFFFF, "int32_t": 0x7FFFFFFF,
    "uint64_t": 0xFFFFFFFFFFFFFFFF,
}  # fmt: skip
"""Type of a field -> the value that means "not known" in most messages (common.xml, attribute `invalid`)."""


def array_length(kind: type[Message], field: str) -> int:
    """Return the items of a field; 0: it is not an array. -1: it is text."""
    if _type(kind, field) == "char":
        return -1
    return int(kind.array_lengths[kind.ordered_fieldnames.index(field)])


def numeric_fields(kind: type[Message]) -> Iterator[tuple[str, int]]:
    """Yield the numeric fields of a kind of message, an array item by item: name and index."""
    for name in kind.fieldnames:
        length = array_length(kind, name)
        if length >= 0:
            yield from ((name, index) for index in range(length)) if length else [(name, -1)]


def make_reader(kind: type[Message], field: str, index: int) -> Reader | None:
    """Return a function that reads a field in its usual unit; None if the message has no such number."""
    if field not in kind.fieldnames or (field, index) not in set(numeric_fields(kind)):
        return None
    unknown = None if kind.fieldenums_by_name.get(field) else _UNKNOWN.get(_type(kind, field))
    factor = _scale(kind, field)[0]

    def read(message: Message) -> float | None:
        value = field_value(message, field)
        if index >= 0:
            value = value[index]
        if value == unknown or not math.isfinite(value):
            return None
        return float(value * factor)

    return read


def build_info(field: FieldId, kind: type[Message]) -> FieldInfo:
    """Return unit, decimals and names of values of a field."""
    _, unit, decimals = _scale(kind, field.field)
    enum = kind.fieldenums_by_name.get(field.field, "")
    bitmask = kind.fielddisplays_by_name.get(field.field) == "bitmask"
    names = () if not enum or bitmask else tuple(enum_names(enum).items())
    if enum or (not unit and "float" not in _type(kind, field.field)):
        decimals = 0
    return FieldInfo(field, unit, decimals, names)


def format_value(value: float | None, info: FieldInfo) -> str:
    """Return a value with its unit, or the name of an enum value."""
    if value is None:
        return "--"
    name = dict(info.names).get(int(value)) if info.names else None
    return name or f"{value:.{info.decimals}f} {info.unit}".rstrip()


def rank_fields(text: str, fields: Iterable[FieldId]) -> list[FieldId]:
    """Return the fields whose name matches all words of a text, the best first."""
    words = text.lower().split()
    found: list[tuple[float, FieldId]] = []
    for field in fields:
        scores = [match_score(word, f"{field.name} {field.source}") for word in words]
        if None not in scores:
            further = 0.5 if field.index > 0 else 0.0  # most arrays use their first items only
            found.append((further + sum(score for score in scores if score is not None), field))
    return [field for _, field in sorted(found)]


def _type(kind: type[Message], field: str) -> str:
    return str(kind.fieldtypes[kind.fieldnames.index(field)])


def _scale(kind: type[Message], field: str) -> tuple[float, str, int]:
    unit = kind.fieldunits_by_name.get(field, "")
    return UNITS.get(unit) or (1.0, unit, DECIMALS)
