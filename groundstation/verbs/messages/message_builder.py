"""Builds a message of `field=value` words. Every mistake is one line that names the field."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from dialects.codec import EncodeError, encode_payload
from dialects.enum_names import enum_names
from dialects.messages import ExtraMessage, Message
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.nearest import describe_nearest
from groundstation.verbs.messages.message_values import find_field
from link.services.param.float32 import is_float32


def parse_fields(kind: type[Message], words: Sequence[str]) -> dict[str, Any]:
    """Return the values that the words give. Raises VerbError."""
    values: dict[str, Any] = {}
    for word in words:
        name, given, text = word.partition("=")
        if not given:
            raise VerbError(ExitCode.USAGE, f"{word!r}: write field=value")
        path = find_field(kind, name)
        if path.index is not None:
            raise VerbError(ExitCode.USAGE, f"{word!r}: give the whole array, as in {path.name}=1,2,3")
        if name in values:
            raise VerbError(ExitCode.USAGE, f"{name} is given twice")
        values[name] = _parse(kind, name, text)
    return values


def build(kind: type[Message], values: Mapping[str, Any]) -> Message:
    """Return the message; fields that are not given are 0. Raises VerbError."""
    whole = {name: values.get(name, _zero(kind, name)) for name in kind.fieldnames}
    message = kind(whole) if issubclass(kind, ExtraMessage) else kind(**whole)
    try:
        encode_payload(message)
    except EncodeError as error:
        raise VerbError(ExitCode.USAGE, str(error)) from None
    return message


def _shape(kind: type[Message], name: str) -> tuple[str, int]:
    """Return the type of a field, and its length; 0 if it is not an array."""
    length = kind.array_lengths[kind.ordered_fieldnames.index(name)]
    return kind.fieldtypes[kind.fieldnames.index(name)], length


def _zero(kind: type[Message], name: str) -> Any:
    what, length = _shape(kind, name)
    if what == "char":
        return b"" if length else b"\0"
    return [0] * length if length else 0


def _parse(kind: type[Message], name: str, text: str) -> Any:
    what, length = _shape(kind, name)
    if what == "char":
        return _parse_text(name, text, max(length, 1))
    if not length:
        return _parse_number(kind, name, what, text)
    items = [_parse_number(kind, name, what, item) for item in text.split(",")]
    if len(items) > length:
        raise VerbError(ExitCode.USAGE, f"{name}: {len(items)} values, but the array has {length}")
    return items + [0] * (length - len(items))


def _parse_text(name: str, text: str, length: int) -> bytes:
    raw = text.encode()
    if len(raw) > length:
        raise VerbError(ExitCode.USAGE, f"{name}: {len(raw)} bytes, but the field has {length}")
    return raw


def _parse_number(kind: type[Message], name: str, what: str, text: str) -> float:
    """Return a number in the range of the type `what`; names of the field's enum are numbers."""
    enum = kind.fieldenums_by_name.get(name, "")
    named = {each: number for number, each in enum_names(enum).items()}
    if text.upper() in named:
        return named[text.upper()]
    try:
        value: float = float(text) if what in ("float", "double") else int(text, 0)
    except ValueError:
        hint = describe_nearest(text.upper(), named) if named else ""
        raise VerbError(ExitCode.USAGE, f"{name}: {text!r} is not a {_describe(what)}{hint}") from None
    low, high = _range(what)
    if not math.isnan(value) and (not low <= value <= high or (what == "float" and not is_float32(value))):
        raise VerbError(ExitCode.USAGE, f"{name}: {text} does not fit {what}")
    return value


def _range(what: str) -> tuple[float, float]:
    """Return the smallest and the largest value of a type; of floats any number that is finite."""
    if what in ("float", "double"):
        largest = math.ldexp(1.0, 1023) * (2 - 2**-52)
        return -largest, largest
    bits = int("".join(filter(str.isdigit, what)))
    return (0, 2**bits - 1) if what.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _describe(what: str) -> str:
    return "number" if what in ("float", "double") else "whole number"
