"""Reads and checks the attributes of elements. A mistake raises DialectError with the place and the remedy."""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping

from dialects.extra.definitions import TYPES, Entry, Field, FilePosition
from dialects.extra.errors import DialectError

Attributes = Mapping[str, str]

HIGHEST_ID = 0xFFFFFF
"""A message id has 24 bits."""
NAME_MAX = 100
"""Characters of a name; the longest one of the official definitions has 59."""
UNITS_MAX = 20
"""Characters of a unit; "cm^3/min" is the longest official one."""

_NAME = re.compile(rf"[A-Za-z_][A-Za-z0-9_]{{0,{NAME_MAX - 1}}}")
_NUMBER = re.compile(r"[0-9]{1,8}")
_TYPE = re.compile(r"(?P<type>[a-z0-9_]+)(?:\[(?P<length>[0-9]{1,3})\])?")
_VALUE = re.compile(
    r"(?P<decimal>-?(?:0|[1-9][0-9]{0,19}))|0[xX](?P<hex>[0-9a-fA-F]{1,16})|0[bB](?P<bits>[01]{1,64})"
    r"|2\*\*(?P<power>[0-9]{1,2})"
)
"""The forms of mavschema.xsd, and negative numbers."""
_VERSION_TYPE = "uint8_t_mavlink_version"
"""Type of the version in HEARTBEAT."""


def required(attributes: Attributes, key: str, element: str, place: FilePosition) -> str:
    """Return an attribute that the element must have."""
    if key not in attributes:
        raise DialectError(f'{place}: <{element}> has no {key}: add {key}="..."')
    return attributes[key]


def read_name(attributes: Attributes, element: str, place: FilePosition) -> str:
    """Return the name of an element: an identifier, so that it may stand on the screen and in a filter."""
    name = required(attributes, "name", element, place)
    if not _NAME.fullmatch(name):
        what = f"use at most {NAME_MAX} letters, digits and _, no digit first"
        raise DialectError(f"{place}: {_shown(name)} is not a valid {element} name: {what}")
    return name


def read_id(attributes: Attributes, place: FilePosition) -> int:
    """Return the id of a message."""
    text = required(attributes, "id", "message", place)
    if not _NUMBER.fullmatch(text) or int(text) > HIGHEST_ID:
        raise DialectError(f"{place}: {_shown(text)} is not a message id: use a number from 0 to {HIGHEST_ID}")
    return int(text)


def read_field(attributes: Attributes, place: FilePosition) -> Field:
    """Return a field of a message."""
    name = read_name(attributes, "field", place)
    kind, length = _read_type(required(attributes, "type", "field", place), name, place)
    return Field(
        name, kind, length, _read_units(attributes.get("units", ""), name, place), attributes.get("enum", ""),
        attributes.get("display") == "bitmask", place,
    )  # fmt: skip


def read_entry(attributes: Attributes, highest: int, place: FilePosition) -> Entry:
    """Return an entry of an enum; without a value it gets the one above the `highest`."""
    name = read_name(attributes, "entry", place)
    if "value" not in attributes:
        return Entry(name, highest + 1, True, place)
    return Entry(name, _read_value(attributes["value"], name, place), False, place)


def _read_type(text: str, name: str, place: FilePosition) -> tuple[str, int]:
    """Return the type without its array, and the length of the array."""
    match = _TYPE.fullmatch(text)
    kind = match["type"].replace(_VERSION_TYPE, "uint8_t") if match else ""
    if match is None or kind not in TYPES:
        near = difflib.get_close_matches(text[:NAME_MAX], TYPES, n=1)
        what = f"did you mean {near[0]}?" if near else f"use {', '.join(TYPES)}, or an array such as char[16]"
        raise DialectError(f"{place}: field {name}: unknown type {_shown(text)}: {what}")
    length = int(match["length"] or 0)
    if match["length"] and not 1 <= length <= 255:
        raise DialectError(f"{place}: field {name}: an array has 1 to 255 items, not {length}")
    return kind, length


def _read_units(text: str, name: str, place: FilePosition) -> str:
    if len(text) > UNITS_MAX or not text.isprintable():
        raise DialectError(f"{place}: field {name}: units {_shown(text)}: use at most {UNITS_MAX} printable characters")
    return text


def _read_value(text: str, name: str, place: FilePosition) -> int:
    match = _VALUE.fullmatch(text)
    value = _number(match) if match else None
    if value is None or not -(1 << 63) <= value < 1 << 64:
        raise DialectError(
            f"{place}: entry {name}: {_shown(text)} is not a value: use up to 64 bits: a number, 0x..., 0b... or 2**n"
        )
    return value


def _number(match: re.Match[str]) -> int:
    if match["decimal"]:
        return int(match["decimal"])
    if match["power"]:
        return 1 << int(match["power"])
    return int(match["hex"], 16) if match["hex"] else int(match["bits"], 2)


def _shown(text: str) -> str:
    """Return a text of the file in quotes, short and without control characters."""
    return ascii(text if len(text) <= 40 else f"{text[:40]}...")
