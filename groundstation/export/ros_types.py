"""Messages of MAVLink as types of ROS: definitions (ros2msg), made from the dialect, and values for them."""

from __future__ import annotations

import keyword
import re
from typing import Any

import numpy as np

from dialects.messages import Message, field_value

PACKAGE = "mavlink"
BASES = {
    "char": "uint8", "int8_t": "int8", "uint8_t": "uint8", "int16_t": "int16", "uint16_t": "uint16",
    "int32_t": "int32", "uint32_t": "uint32", "int64_t": "int64", "uint64_t": "uint64", "float": "float32",
    "double": "float64",
}  # fmt: skip
"""Type of a MAVLink field -> type of ROS. An array of char is a string."""
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


class RosType:
    """How a message of MAVLink is written as a message of ROS."""

    def __init__(self, kind: type[Message]) -> None:
        self.name = f"{PACKAGE}/msg/{type_name(kind.msgname)}"
        lengths = dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))
        self._fields = [(name, of, lengths[name]) for name, of in zip(kind.fieldnames, kind.fieldtypes, strict=True)]
        self.definition = "".join(_line(kind, *each) for each in self._fields)

    def values(self, message: Message) -> list[Any]:
        """Return the values of the fields, in their order."""
        return [_value(field_value(message, name), of, length) for name, of, length in self._fields]


def type_name(name: str) -> str:
    """Return the name of a type: "GlobalPositionInt" for GLOBAL_POSITION_INT."""
    joined = "".join(part.capitalize() for part in name.split("_"))
    return joined if joined[:1].isalpha() else f"Message{joined}"


def _line(kind: type[Message], name: str, of: str, length: int) -> str:
    """Return the line of a field, with its unit and enum as a comment."""
    base = "string" if of == "char" and length else f"{BASES[of]}[{length}]" if length else BASES[of]
    notes = [kind.fieldunits_by_name.get(name, ""), kind.fieldenums_by_name.get(name, "")]
    comment = " ".join(filter(None, notes))
    return f"{base} {_field_name(name)}{f'  # {comment}' if comment else ''}\n"


def _field_name(name: str) -> str:
    """Return the name as it is; one that a reader in Python could not have gets a prefix."""
    return f"field_{name}" if keyword.iskeyword(name) or not _NAME.fullmatch(name) else name


def _value(value: Any, of: str, length: int) -> Any:
    if of == "char":
        return value if length else ord(value[0]) & 0xFF if value else 0
    return np.array(value, dtype=BASES[of]) if length else value
