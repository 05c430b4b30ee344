"""What a framer returns: frames, and counters."""

from __future__ import annotations

from collections.abc import Container, Iterable
from typing import NamedTuple

import msgspec

from dialects.codec import CRC_SIZE, HEADER_V1, HEADER_V2, INCOMPAT_SIGNED, MAGIC_V1, MAGIC_V2, SIGNATURE_SIZE
from dialects.messages import MESSAGES

MISMATCH_AFTER = 3
"""Complete frames with a foreign checksum that prove another dialect; a single one may be an accident."""
NOISE_HINT_BYTES = 512
"""Bytes without a valid frame after which the user is told. Half a second of telemetry at 57600 baud is more, a boot
message or ModemManager's "AT" is less."""


Frame = tuple[int, int, int, int, bytes]
"""A complete frame with a valid checksum, or (Framer(unknown=True)) one with an id outside the dialect: message id,
system, component, sequence, and the whole frame as received. A plain tuple: a NamedTuple takes five times as long to
create, and a router creates half a million a second."""


def payload_of(raw: bytes) -> bytes:
    """Return the payload of a whole frame as received, with or without its trailing zeros."""
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
    """Return the header at `start`; None where there is none, or one with unknown flags."""
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


MAX_UNKNOWN = 64
"""Messages with ids outside the dialect that are counted one by one."""

UnknownKey = tuple[int, int, int]
"""System, component, message id; of a frame that could not be verified."""


class FramerCounts(msgspec.Struct):
    """What a framer has counted so far."""

    frames: int = 0
    crc_errors: int = 0
    resync_bytes: int = 0
    """Bytes outside of any frame."""
    unknown: int = 0
    """Complete frames with an id outside the dialect."""
    refused: int = 0
    """Frames with unknown flags, or MAVLink 1 frames of the wrong length."""
    mismatches: dict[int, int] = msgspec.field(default_factory=dict)
    """Known id -> how many complete frames had the checksum of another definition."""
    unknown_ids: dict[UnknownKey, tuple[int, int]] = msgspec.field(default_factory=dict)
    """Of `unknown`, by source and id: frames, and bytes of the newest one. Frames that are returned are left out."""

    def add_unknown(self, key: UnknownKey, frames: int, size: int) -> None:
        """Count frames with an id outside the dialect. `size`: bytes of the newest one."""
        before = self.unknown_ids.get(key)
        if before is not None:
            self.unknown_ids[key] = before[0] + frames, size
        elif len(self.unknown_ids) < MAX_UNKNOWN:
            self.unknown_ids[key] = frames, size

    def add(self, more: FramerCounts) -> None:
        """Add the counts of another framer."""
        self.frames += more.frames
        self.crc_errors += more.crc_errors
        self.resync_bytes += more.resync_bytes
        self.unknown += more.unknown
        self.refused += more.refused
        for number, times in more.mismatches.items():
            self.mismatches[number] = self.mismatches.get(number, 0) + times
        for key, (frames, size) in more.unknown_ids.items():
            self.add_unknown(key, frames, size)


def sum_counts(several: Iterable[FramerCounts]) -> FramerCounts:
    """Return the sum of the counts of several framers."""
    total = FramerCounts()
    for each in several:
        total.add(each)
    return total


def find_mismatches(counts: FramerCounts, proven: Container[int] = ()) -> tuple[str, ...]:
    """Return the names of the messages that arrive complete but with the checksum of another definition.

    `proven`: ids of messages that have arrived with the right checksum, too: their wrong ones are damage.
    """
    return tuple(
        sorted(
            MESSAGES[each].msgname
            for each, times in counts.mismatches.items()
            if times >= MISMATCH_AFTER and each not in proven
        )
    )


def noise_hint(name: str, received: int, frames: int) -> str | None:
    """Return a warning when `received` bytes have held no valid frame, or None."""
    if received < NOISE_HINT_BYTES or frames:
        return None
    return f"{name}: bytes arrive, but no MAVLink frame; wrong baud rate?"
