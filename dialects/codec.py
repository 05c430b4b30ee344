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

_DECODERS: dict[int, tuple[int, Callable[[bytes], Message]]] = {
    number: (message.unpacker.size, rover.DECODERS[number]) for number, message in MESSAGES.items()
}
"""Message id -> length of the whole payload, and the function that takes it."""
_ENCODERS: dict[int, Any] = rover.ENCODERS
_CHECKED = {number: (number.to_bytes(3, "little"), CRC_EXTRA[number]) for number in MESSAGES}
"""Message id -> its bytes in a header, and the last byte of its checksum."""
_MAGIC = bytes([MAGIC_V2])
_pack_header = struct.Struct("<BBxBBB3s").pack
"""Header behind the start byte: length, incompatibility flags, sequence, system, component, id."""
_pack_crc = struct.Struct("<H").pack


class EncodeError(ValueError):
    """A field of an outgoing message does not fit its type. Received data never causes it."""


def decode(message_id: int, payload: bytes) -> Message:
    """Return the message of a verified payload.

    Truncated zeros are restored, bytes of unknown extensions are dropped. Raises KeyError for an unknown id.
    """
    size, decoder = _DECODERS[message_id]
    length = len(payload)
    if length != size:
        payload = payload.ljust(size, b"\0") if length < size else payload[:size]
    return decoder(payload)


def decode_frame(message_id: int, raw: bytes) -> Message:
    """Return the message of a whole verified frame, as decode() does. Received frames take this way."""
    size, decoder = _DECODERS[message_id]
    length = raw[1]
    start = HEADER_V2 if raw[0] == MAGIC_V2 else HEADER_V1
    payload = raw[start : start + length]
    if length != size:
        payload = payload.ljust(size, b"\0") if length < size else payload[:size]
    return decoder(payload)


def encode_payload(message: Message) -> bytes:
    """Return the payload without its trailing zeros, at least one byte (MAVLink 2 payload truncation)."""
    try:
        payload: bytes = _ENCODERS[type(message).id](message)  # STATUSTEXT has a field `id`
    except (struct.error, TypeError, OverflowError) as error:
        raise EncodeError(f"{type(message).msgname}: {error}") from error
    return payload.rstrip(b"\0") or b"\0"


def frame(message_id: int, payload: bytes, sequence: int, system: int, component: int, flags: int = 0) -> bytes:
    """Return a MAVLink 2 frame without signature. `sequence`, `system` and `component` are 0..255."""
    number, extra = _CHECKED[message_id]
    body = _pack_header(len(payload), flags, sequence, system, component, number) + payload
    return _MAGIC + body + _pack_crc(mcrf4xx(body + extra))


def frame_v1(message_id: int, payload: bytes, sequence: int, system: int, component: int) -> bytes:
    """Return a MAVLink 1 frame, which has no extensions and no id above 255."""
    size = BASE_SIZE[message_id]
    body = bytes([size, sequence, system, component, message_id]) + payload[:size].ljust(size, b"\0")
    return bytes([MAGIC_V1]) + body + _pack_crc(mcrf4xx(body + CRC_EXTRA[message_id]))


def frame_to_sign(message_id: int, payload: bytes, sequence: int, system: int, component: int) -> bytes:
    """Return a MAVLink 2 frame with the flag for signed frames; link id, timestamp and signature must follow it."""
    return frame(message_id, payload, sequence, system, component, INCOMPAT_SIGNED)


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
    _CHECKED[number] = number.to_bytes(3, "little"), CRC_EXTRA[number]
    _DECODERS[number] = message.unpacker.size, decoder
    _ENCODERS[number] = encoder
