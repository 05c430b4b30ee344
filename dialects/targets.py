"""Reads the target system and component of a raw frame, so that a router need not decode payloads."""

from __future__ import annotations

import struct

from dialects.codec import HEADER_V1, HEADER_V2, MAGIC_V2
from dialects.messages import MESSAGES, ManualControl, Message

BROADCAST = (0, 0)
"""Target system and component of a message to all systems."""

_TARGET_FIELD = {ManualControl.id: "target"}
"""Messages whose target field has another name (mavgen treats it the same: mavparse.py, "target_system_ofs")."""


def _offsets(message: type[Message]) -> dict[str, int]:
    """Return the offset of each field in the payload. Fields lie without gaps, in wire order."""
    sizes = [struct.calcsize("<" + each) for each in bytes(message.native_format).decode().removeprefix("<")]
    starts: dict[str, int] = {}
    at = 0
    for name, size, length in zip(message.ordered_fieldnames, sizes, message.array_lengths, strict=True):
        starts[name] = at
        at += size * (length or 1)
    return starts


TARGETS: dict[int, tuple[int, int | None]] = {}
"""Message id -> payload offsets of target system and component (None: the message has no such field)."""


def register(message: type[Message]) -> None:
    """Add the target fields of a message, in place of those of another one with its id."""
    number = message.id
    field = _TARGET_FIELD.get(number, "target_system")
    TARGETS.pop(number, None)
    if field in message.fieldnames:
        starts = _offsets(message)
        TARGETS[number] = (starts[field], starts.get("target_component"))


for _message in MESSAGES.values():
    register(_message)


def target_of(message_id: int, raw: bytes) -> tuple[int, int]:
    """Return the target system and component of a whole frame.

    Truncated fields are 0. A message without target fields is for all systems.
    """
    offsets = TARGETS.get(message_id)
    if offsets is None:
        return BROADCAST
    start = HEADER_V2 if raw[0] == MAGIC_V2 else HEADER_V1
    end = start + raw[1]
    system, component = offsets
    system += start
    if component is None:
        return (raw[system] if system < end else 0, 0)
    component += start
    return (raw[system] if system < end else 0, raw[component] if component < end else 0)
