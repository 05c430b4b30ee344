"""Values of the fields of any message: raw, as MAVLink defines them, without conversion of units."""

from __future__ import annotations

from typing import Any

from dialects.messages import ExtraMessage, Message, StatusText, decode_text, printable


def field_value(message: Message, name: str) -> Any:
    """Return a value: a number, a text, or a list."""
    if isinstance(message, ExtraMessage):
        value = message.values[name]
    elif isinstance(message, StatusText) and name == "text":
        value = decode_text(message)
    else:
        value = getattr(message, name)
    if isinstance(value, bytes):
        value = value.split(b"\0", 1)[0].decode("utf-8", "replace")
    if isinstance(value, str):
        return printable(value)
    return list(value) if isinstance(value, tuple | list) else value
