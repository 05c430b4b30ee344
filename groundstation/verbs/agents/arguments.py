"""Arguments of the tools of agents: their JSON schema, and the check of what an agent sends."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from enum import Enum
from typing import Any

import msgspec

LONGEST_TEXT = 200
"""Characters of a text."""


class ArgumentKind(Enum):
    """Types of arguments, by their names in a JSON schema."""

    NUMBER = "number"
    INTEGER = "integer"
    TEXT = "string"


class Argument(msgspec.Struct, frozen=True):
    """One argument of a tool."""

    name: str
    help: str
    kind: ArgumentKind = ArgumentKind.NUMBER
    low: float = -math.inf
    high: float = math.inf
    pattern: str = ""
    """Regular expression of a whole text; "": any words."""
    needed: bool = True
    default: Any = None
    """Of one that is not needed."""

    @property
    def schema(self) -> dict[str, Any]:
        """Return its JSON schema."""
        schema: dict[str, Any] = {"type": self.kind.value, "description": self.help}
        if self.kind is ArgumentKind.TEXT:
            schema["maxLength"] = LONGEST_TEXT
            if self.pattern:
                schema["pattern"] = f"^{self.pattern}$"
            return schema
        if math.isfinite(self.low):
            schema["minimum"] = self.low
        if math.isfinite(self.high):
            schema["maximum"] = self.high
        return schema


class InvalidArgumentError(ValueError):
    """An argument that cannot be right; the message is one line for the agent."""


def build_schema(arguments: Sequence[Argument]) -> dict[str, Any]:
    """Return the JSON schema of all arguments of a tool."""
    return {
        "type": "object",
        "properties": {each.name: each.schema for each in arguments},
        "required": [each.name for each in arguments if each.needed],
        "additionalProperties": False,
    }


def check_arguments(arguments: Sequence[Argument], given: object) -> dict[str, Any]:
    """Return the arguments with their defaults. Raises InvalidArgumentError."""
    if not isinstance(given, Mapping):
        raise InvalidArgumentError("the arguments are no object")
    known = {each.name: each for each in arguments}
    for name in given:
        if name not in known:
            raise InvalidArgumentError(f"{_short(name)}: no such argument; it has {', '.join(known) or 'none'}")
    missing = [each.name for each in arguments if each.needed and given.get(each.name) is None]
    if missing:
        raise InvalidArgumentError(f"{missing[0]} is missing")
    return {
        name: each.default if given.get(name) is None else _check(each, given[name]) for name, each in known.items()
    }


def _check(argument: Argument, value: object) -> Any:
    if argument.kind is ArgumentKind.TEXT:
        return _check_text(argument, value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InvalidArgumentError(f"{argument.name}: {_short(value)} is not a number")
    if not (argument.low <= value <= argument.high and abs(value) < math.inf):  # also NaN
        raise InvalidArgumentError(f"{argument.name}: {_short(value)} is not {_range(argument)}")
    if argument.kind is ArgumentKind.INTEGER and value != int(value):
        raise InvalidArgumentError(f"{argument.name}: {_short(value)} is not a whole number")
    return int(value) if argument.kind is ArgumentKind.INTEGER else float(value)


def _check_text(argument: Argument, value: object) -> str:
    if not isinstance(value, str):
        raise InvalidArgumentError(f"{argument.name}: {_short(value)} is not a text")
    if len(value) > LONGEST_TEXT:
        raise InvalidArgumentError(f"{argument.name}: {len(value)} characters; {LONGEST_TEXT} at most")
    text = " ".join(value.split(" "))
    if not text.isprintable():
        raise InvalidArgumentError(f"{argument.name}: it has characters that cannot be printed: {_short(value)}")
    text = " ".join(text.split())
    if not text:
        raise InvalidArgumentError(f"{argument.name} is empty")
    if argument.pattern and not re.fullmatch(argument.pattern, text, re.ASCII):
        raise InvalidArgumentError(f"{argument.name}: {_short(text)} is not {argument.help}")
    return text


def _range(argument: Argument) -> str:
    if math.isinf(argument.low) and math.isinf(argument.high):
        return "a finite number"
    return f"from {argument.low:g} to {argument.high:g}"


def _short(value: object) -> str:
    """Return a value for a message: ASCII, and short."""
    text = ascii(value if isinstance(value, str | int | float | bool | None) else type(value).__name__)
    return text if len(text) <= 60 else f"{text[:57]}..."
