"""Payload bytes <-> messages, and the bytes of a whole frame to send, on the functions that build.py generates.

Finding frames in received bytes is link/protocol/framer.py's work; sequence numbers are link/protocol/channel.py's.
"""

from __future__ import annotations

import struct
from typing import Any

from fastcrc.crc16 import mcrf4xx

from dialects import rover
from dialects.messages import MESSAGES, Message

MAGIC_V1, MAGIC_V2 = 0xFE, 0xFD
HEADER_V1, HEADER_V2 = 6, 10
CRC_SIZE, SIGNATURE_SIZE = 2, 13
INCOMPAT_SIGNED = 0x01
MAX_FRAME = 280
"""Longest frame: 10 header, 255 payload, 2 checksum, 13 signature (MAVLink serialization guide)."""

CRC_EXTRA: dict[int, bytes] = {number: bytes([message.crc_extra]) for number, message in MESSAGES.items()}
"""The byte that ends each message's checksum: other definitions of the same id fail on it."""

BASE_SIZE: dict[int, int] = rover.BASE_SIZES
"""Payload length without extensions: the exact length of a MAVLink 1 frame."""

_ZEROS = bytes(255)
_SIZES = {number: message.unpacker.size for number, message in MESSAGES.items()}
_DECODERS: dict[int, Any] = rover.DECODERS
_ENCODERS: dict[int, Any] = rover.ENCODERS
_MAGIC = bytes([MAGIC_V2])
_HEADER = struct.Struct("<B2xBBBHB")
"""What follows the start byte: length, no flags of either kind, sequence, system, component, id in two parts."""
_CRC = struct.Struct("<H")


class EncodeError(ValueError):
    """A field of an outgoing message does not fit its type. A fault of ours, never of the wire."""


def decode(message_id: int, payload: bytes) -> Message:
    """The message of a checked payload. Cut trailing zeros are put back, bytes of unknown extensions are dropped.

    Raises KeyError for an id outside the dialect.
    """
    size = _SIZES[message_id]
    length = len(payload)
    if length < size:
        payload += _ZEROS[: size - length]
    elif length > size:
        payload = payload[:size]
    message: Message = _DECODERS[message_id](payload)
    return message


def encode_payload(message: Message) -> bytes:
    """The payload without its trailing zeros, at least one byte (MAVLink 2 payload truncation)."""
    try:
        payload: bytes = _ENCODERS[type(message).id](message)  # STATUSTEXT has a field `id`
    except (struct.error, TypeError, OverflowError) as error:
        raise EncodeError(f"{message.msgname}: {error}") from error
    return payload.rstrip(b"\0") or b"\0"


def frame(message_id: int, payload: bytes, sequence: int, system: int, component: int) -> bytes:
    """An unsigned MAVLink 2 frame. `sequence`, `system` and `component` are 0..255."""
    body = _HEADER.pack(len(payload), sequence, system, component, message_id & 0xFFFF, message_id >> 16) + payload
    return _MAGIC + body + _CRC.pack(mcrf4xx(body + CRC_EXTRA[message_id]))
