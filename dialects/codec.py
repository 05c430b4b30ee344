"""Encodes and decodes payloads, and builds frames to send, with the functions that build.py generates.

link/protocol/framer.py finds frames in received bytes; link/protocol/channel.py numbers those that are sent.
Frame format: https://mavlink.io/en/guide/serialization.html.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any

from fastcrc.crc16 import mcrf4xx

from dialects import rover
from dialects.messages import MESSAGES, Message

MAGIC_V1, MAGIC_V2 = 0xFE, 0xFD
HEADER_V1, HEADER_V2 = 6, 10
CRC_SIZE, SIGNATURE_SIZE = 2, 13
INCOMPAT_SIGNED = 0x01
MAX_FRAME = 280
"""Longest frame, bytes: header 10, payload 255, checksum 2, signature 13."""

CRC_EXTRA: dict[int, bytes] = {number: bytes([message.crc_extra]) for number, message in MESSAGES.items()}
"""Last byte of each message's checksum, by which a different definition of the same id fails."""

BASE_SIZE: dict[int, int] = rover.BASE_SIZES
"""Payload length without extensions: the exact payload length of a MAVLink 1 frame."""

_ZEROS = bytes(255)
_SIZES = {number: message.unpacker.size for number, message in MESSAGES.items()}
_DECODERS: dict[int, Any] = rover.DECODERS
_ENCODERS: dict[int, Any] = rover.ENCODERS
_MAGIC = bytes([MAGIC_V2])
_HEADER = struct.Struct("<B2xBBBHB")
"""Header behind the start byte: length, flags (all 0), sequence, system, component, id in two parts."""
_CRC = struct.Struct("<H")


class EncodeError(ValueError):
    """A field of an outgoing message does not fit its type. Received data never causes it."""


def decode(message_id: int, payload: bytes) -> Message:
    """Return the message of a verified payload.

    Truncated zeros are restored, bytes of unknown extensions are dropped. Raises KeyError for an unknown id.
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
    """Return the payload without its trailing zeros, at least one byte (MAVLink 2 payload truncation)."""
    try:
        payload: bytes = _ENCODERS[type(message).id](message)  # STATUSTEXT has a field `id`
    except (struct.error, TypeError, OverflowError) as error:
        raise EncodeError(f"{type(message).msgname}: {error}") from error
    return payload.rstrip(b"\0") or b"\0"


def frame(message_id: int, payload: bytes, sequence: int, system: int, component: int) -> bytes:
    """Return an unsigned MAVLink 2 frame. `sequence`, `system` and `component` are 0..255."""
    body = _HEADER.pack(len(payload), sequence, system, component, message_id & 0xFFFF, message_id >> 16) + payload
    return _MAGIC + body + _CRC.pack(mcrf4xx(body + CRC_EXTRA[message_id]))


def register(
    message: type[Message], base_size: int, decoder: Callable[[bytes], Message], encoder: Callable[[Any], bytes]
) -> None:
    """Add a message to the dialect of this process, or replace one: before a link opens, never later.

    `base_size`: payload length without extensions. `decoder` takes, and `encoder` returns, the whole payload.
    """
    number = message.id
    MESSAGES[number] = message
    CRC_EXTRA[number] = bytes([message.crc_extra])
    BASE_SIZE[number] = base_size
    _SIZES[number] = message.unpacker.size
    _DECODERS[number] = decoder
    _ENCODERS[number] = encoder
