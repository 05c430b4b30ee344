"""What a framer hands back: frames, and counts of what it has seen."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from dialects.codec import CRC_SIZE, HEADER_V1, HEADER_V2, INCOMPAT_SIGNED, MAGIC_V1, MAGIC_V2, SIGNATURE_SIZE

NOISE_HINT_BYTES = 512
"""Bytes without a single frame after which somebody should be told: half a second of telemetry at 57600 baud is more,
a boot message or ModemManager's "AT" is less."""


Frame = tuple[int, int, int, int, bytes]
"""A whole frame with a right checksum, or (Framer(unknown=True)) one of an id that nobody here can check: message id,
system, component, sequence number, and all of it as received. No names: a NamedTuple takes five times as long to make,
and a router makes half a million a second."""


def payload_of(raw: bytes) -> bytes:
    """The payload of a whole frame as received, its trailing zeros cut by the sender or not."""
    start = HEADER_V2 if raw[0] == MAGIC_V2 else HEADER_V1
    return raw[start : start + raw[1]]


class Header(NamedTuple):
    """What the first bytes of a frame claim."""

    message_id: int
    system: int
    component: int
    sequence: int
    size: int
    """Of the whole frame, bytes."""


def read_header(data: bytes, start: int = 0) -> Header | None:
    """The header at `start`; None where there is none, or one with flags that we do not know."""
    if data[start] == MAGIC_V1 and len(data) - start >= HEADER_V1 + CRC_SIZE:
        length, sequence, system, component, message_id = data[start + 1 : start + HEADER_V1]
        return Header(message_id, system, component, sequence, HEADER_V1 + length + CRC_SIZE)
    if data[start] != MAGIC_V2 or len(data) - start < HEADER_V2 + CRC_SIZE:
        return None
    length, flags, _, sequence, system, component, low, middle, high = data[start + 1 : start + HEADER_V2]
    if flags > INCOMPAT_SIGNED:
        return None
    size = HEADER_V2 + length + CRC_SIZE + (SIGNATURE_SIZE if flags else 0)
    return Header(low | middle << 8 | high << 16, system, component, sequence, size)


@dataclass(slots=True)
class FramerCounts:
    """What a framer has seen so far."""

    frames: int = 0
    crc_errors: int = 0
    resync_bytes: int = 0
    """Bytes that belonged to no frame."""
    unknown: int = 0
    """Whole frames with an id outside the dialect."""
    refused: int = 0
    """Frames with flags we do not know, or MAVLink 1 frames of the wrong length."""
    mismatches: dict[int, int] = field(default_factory=dict)
    """Known ids that arrive whole but with another definition's checksum -> how often."""

    def add(self, more: FramerCounts) -> None:
        """Count what another framer has seen, too."""
        self.frames += more.frames
        self.crc_errors += more.crc_errors
        self.resync_bytes += more.resync_bytes
        self.unknown += more.unknown
        self.refused += more.refused
        for number, times in more.mismatches.items():
            self.mismatches[number] = self.mismatches.get(number, 0) + times


def noise_hint(name: str, received: int, frames: int) -> str | None:
    """What to tell of a wire that has brought `received` bytes, when none of them made a frame."""
    if received < NOISE_HINT_BYTES or frames:
        return None
    return f"{name}: bytes and no MAVLink frame among them; wrong baud rate?"
