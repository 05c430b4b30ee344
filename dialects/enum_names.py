"""Names of enum values, for people. Read from the source of the generated module when first needed.

rover.py keeps the values as constants, but not the tables of pymavlink (dialects/build.py): they would cost every
program memory, and only the ground station's Messages screen shows names of all enums.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from itertools import takewhile
from pathlib import Path

from dialects import rover
from dialects.enums import LACKING

_LINE = re.compile(r"^(?:# (?P<enum>[A-Z]\w*)|(?P<name>[A-Z]\w*) = (?P<value>-?\d+))$", re.MULTILINE)
_END = "_ENUM_END"

_added: dict[str, dict[int, str]] = {}
"""Enum -> value -> name, of a dialect that was added."""


def add_enum_names(enum: str, names: Mapping[int, str]) -> None:
    """Add names of an enum to those of the built-in dialect, which go first for the same value."""
    _added.setdefault(enum, {}).update(names)
    enum_names.cache_clear()


@cache
def enum_names(enum: str) -> Mapping[int, str]:
    """Return value -> short name of an enum, in rising order; empty for one that is not known.

    The part that a name shares with that of the enum is left out: "GCS" and not "MAV_TYPE_GCS".
    """
    names = _added.get(enum, {}) | LACKING.get(enum, {}) | _enums().get(enum, {})
    return {value: _short(name, enum) for value, name in sorted(names.items())}


def flag_names(enum: str, value: int) -> tuple[str, ...]:
    """Return the names of the bits that are set; a bit without a name as its value."""
    names = enum_names(enum)
    bits = (1 << bit for bit in range(value.bit_length()) if value >> bit & 1)
    return tuple(names.get(bit, f"0x{bit:x}") for bit in bits)


@cache
def _enums() -> dict[str, dict[int, str]]:
    """Return enum -> value -> name. Each enum is a comment with its name, constants, and one that ends it."""
    found: dict[str, dict[int, str]] = {}
    enum = ""
    for line in _LINE.finditer(Path(rover.__file__).read_text("utf-8")):
        if line["enum"]:
            enum = line["enum"]
        elif line["name"].endswith(_END):
            enum = ""
        elif enum:
            found.setdefault(enum, {})[int(line["value"])] = line["name"]
    return found


def _short(name: str, enum: str) -> str:
    words = name.split("_")
    shared = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(words, enum.split("_"), strict=False)))
    return "_".join(words[shared:]) or name
