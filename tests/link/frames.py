"""Frames for the tests of link/: made by our encoder, which tests/dialects holds to pymavlink."""

from __future__ import annotations

from dialects import codec
from dialects.axes import Axes, build_manual_control
from dialects.messages import Heartbeat, Message


def frame(message: Message, sequence: int = 0, system: int = 255, component: int = 190) -> bytes:
    """One MAVLink 2 frame, from a ground station unless told otherwise."""
    return codec.frame(type(message).id, codec.encode_payload(message), sequence, system, component)


def demand(sequence: int, throttle: float = 0.5, target: int = 1) -> bytes:
    """A MANUAL_CONTROL frame of 23 bytes."""
    return frame(build_manual_control(Axes(throttle, 0.1), target), sequence)


def heartbeat(sequence: int, system: int = 255, component: int = 190) -> bytes:
    """A ground station's HEARTBEAT."""
    return frame(Heartbeat(6, 8, 0, 0, 4, 3), sequence, system, component)


def version_1(message: Message, sequence: int = 0, system: int = 255, component: int = 190, cut: int = 0) -> bytes:
    """The MAVLink 1 frame of a message without extensions, `cut` bytes of its payload missing."""
    from fastcrc.crc16 import mcrf4xx

    number = type(message).id
    payload = codec.encode_payload(message).ljust(codec.BASE_SIZE[number], b"\0")[: codec.BASE_SIZE[number] - cut]
    body = bytes([len(payload), sequence, system, component, number]) + payload
    return b"\xfe" + body + mcrf4xx(body + codec.CRC_EXTRA[number]).to_bytes(2, "little")
