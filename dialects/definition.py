"""Reads the private messages and enums of rover.xml for the documentation."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import msgspec

FILE = Path(__file__).with_name("rover.xml")
PRIVATE_IDS = range(46000, 46100)
"""Message ids that no public dialect uses."""


class FieldDefinition(msgspec.Struct, frozen=True):
    """One field of a message."""

    name: str
    type: str
    unit: str
    enum: str
    description: str


class MessageDefinition(msgspec.Struct, frozen=True):
    """One message."""

    id: int
    name: str
    description: str
    fields: tuple[FieldDefinition, ...]


class EnumValue(msgspec.Struct, frozen=True):
    """One value of an enum."""

    number: int
    name: str
    description: str


def private_messages() -> list[MessageDefinition]:
    """Return the messages with a private id, in order of their ids."""
    found = [_definition(each) for each in _root().iter("message") if int(each.get("id", 0)) in PRIVATE_IDS]
    return sorted(found, key=lambda each: each.id)


def private_enums() -> dict[str, list[EnumValue]]:
    """Return the enums that rover.xml defines, by name."""
    return {
        each.get("name", ""): [_value(entry) for entry in each.iter("entry")]
        for each in _root().iter("enum")
        if each.get("name", "").startswith("ROVER_")
    }


def _root() -> ET.Element:
    return ET.parse(FILE).getroot()


def _definition(message: ET.Element) -> MessageDefinition:
    fields = tuple(
        FieldDefinition(
            each.get("name", ""), each.get("type", ""), each.get("units", ""), each.get("enum", ""), _text(each)
        )
        for each in message.iter("field")
    )
    return MessageDefinition(
        int(message.get("id", 0)), message.get("name", ""), _text(message.find("description")), fields
    )


def _value(entry: ET.Element) -> EnumValue:
    return EnumValue(int(entry.get("value", "0"), 0), entry.get("name", ""), _text(entry.find("description")))


def _text(element: ET.Element | None) -> str:
    return " ".join((element.text or "").split()) if element is not None else ""
