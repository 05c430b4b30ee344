"""Whom a frame is for, read from its raw bytes: a table of offsets, so that a router needs to decode nothing."""

from __future__ import annotations

import struct

from dialects.codec import HEADER_V1, HEADER_V2, MAGIC_V2
from dialects.messages import MESSAGES, ManualControl, Message

BROADCAST = (0, 0)
"""Target system and component of a message for everybody."""

_TARGET_FIELD = {ManualControl.id: "target"}
"""Messages whose target field has another name (mavgen treats it alike: mavparse.py, "target_system_ofs")."""


def _offsets(message: type[Message]) -> dict[str, int]:
    """Field -> where it starts in the payload. Fields lie without gaps, in wire order."""
    sizes = [struct.calcsize("<" + each) for each in bytes(message.native_format).decode().removeprefix("<")]
    starts: dict[str, int] = {}
    at = 0
    for name, size, length in zip(message.ordered_fieldnames, sizes, message.array_lengths, strict=True):
        starts[name] = at
        at += size * (length or 1)
    return starts


def _targets() -> dict[int, tuple[int, int | None]]:
    table: dict[int, tuple[int, int | None]] = {}
    for number, message in MESSAGES.items():
        field = _TARGET_FIELD.get(number, "target_system")
        if field in message.fieldnames:
            starts = _offsets(message)
            table[number] = (starts[field], starts.get("target_component"))
    return table


TARGETS: dict[int, tuple[int, int | None]] = _targets()
"""Message id -> offsets of target system and component in the payload (None: the message has no such field)."""


def target_of(message_id: int, raw: bytes) -> tuple[int, int]:
    """Target system and component of a whole frame. What zero truncation cut off is 0; no field means everybody."""
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
