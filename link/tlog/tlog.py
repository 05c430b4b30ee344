"""Telemetry log format: time and frame, as MAVProxy, QGroundControl and pymavlink read and write it.

A record is 8 bytes of Unix time in us, big-endian, then the frame as it was sent. There is no header and no index: a
truncated file is complete up to there, and a damaged one is read on from the next valid frame.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import NamedTuple

from dialects.codec import CRC_EXTRA, MAGIC_V1, MAGIC_V2
from dialects.traits import SECRET
from link.protocol.frame import read_header
from link.protocol.framer import Framer

STAMP = 8
_STAMP = struct.Struct(">Q")
_MAGIC_V2 = bytes([MAGIC_V2])
_SECRET = frozenset(number.to_bytes(3, "little") for number in SECRET)
"""Ids as in a MAVLink 2 header."""
_LEAST = STAMP + 8  # with the shortest frame
_DAY = 86_400_000_000


class Record(NamedTuple):
    """One frame and the time it was recorded."""

    microseconds: int
    """Unix time."""
    raw: bytes


def encode_record(microseconds: int, raw: bytes) -> bytes:
    """Return the bytes of one record; none for a message with the trait SECRET."""
    if raw[:1] == _MAGIC_V2 and raw[7:10] in _SECRET:
        return b""
    return _STAMP.pack(microseconds) + raw


def read_records(data: bytes) -> Iterator[Record]:
    """Yield all whole records of a log, in order. Damaged parts are skipped and never raise."""
    at, last, sure = 0, 0, True
    while at + _LEAST <= len(data):
        raw = _frame_at(data, at + STAMP, trust_unknown=sure)
        if raw is None:
            at, sure = at + 1, False
            continue
        (stamp,) = _STAMP.unpack_from(data, at)
        if not sure and not last <= stamp <= last + _DAY:
            stamp = last  # the frame is valid, but the damage reached its time
        yield Record(stamp, raw)
        at, last, sure = at + STAMP + len(raw), stamp, True


def _frame_at(data: bytes, start: int, *, trust_unknown: bool) -> bytes | None:
    """Return the frame at `start`, or None.

    A frame with an unknown id counts only right behind a valid record and before another frame.
    """
    if data[start] not in (MAGIC_V1, MAGIC_V2):
        return None
    header = read_header(data, start)
    if header is None or start + header.size > len(data):
        return None
    end = start + header.size
    raw = data[start:end]
    if header.message_id not in CRC_EXTRA:
        followed = end + STAMP >= len(data) or data[end + STAMP] in (MAGIC_V1, MAGIC_V2)
        return raw if trust_unknown and followed else None
    return raw if Framer(stream=False).feed(raw, 0.0) else None
