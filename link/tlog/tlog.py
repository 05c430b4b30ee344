"""Telemetry log format: time and frame, as MAVProxy, QGroundControl and pymavlink read and write it.

A record is 8 bytes of Unix time in us, big-endian, then the frame as it was sent. There is no header and no index: a
truncated file is complete up to there, and a damaged one is read on from the next valid frame.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from itertools import chain
from typing import BinaryIO, NamedTuple

from dialects.codec import MAGIC_V2
from dialects.traits import SECRET
from link.tlog.scan import BEYOND, CarefulScan, Gap, LogFrame, scan

CHUNK = 1 << 18
"""Bytes of a file that are read at once."""
LATEST = (1 << 63) // 1000 - 1
"""us, in the year 2262: a later time is damaged, and nanoseconds of it would not fit into 64 bits."""
_STAMP = struct.Struct(">Q")
_MAGIC_V2 = bytes([MAGIC_V2])
_SECRET = frozenset(number.to_bytes(3, "little") for number in SECRET)
"""Ids as in a MAVLink 2 header."""
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
    found = _Order().sort(scan(data, 0, len(data), final=True), final=True)
    return (Record(each.stamp, each.raw) for each in found if isinstance(each, LogFrame))


def read_log(file: BinaryIO) -> Iterator[list[LogFrame | Gap]]:
    """Yield the frames and gaps of an open file in lists of about CHUNK bytes: a large log needs little memory.

    No stamp of a frame is later than LATEST. Raises OSError.
    """
    order, block, base, sure = _Order(), b"", 0, True
    file.seek(0)
    while True:
        data = file.read(CHUNK)
        block += data
        limit = base + len(block) - (BEYOND if data else 0)
        if limit > base or not data:
            part = scan(block, base, limit, final=not data, sure=sure)
            yield order.sort(part, final=not data)
            block, base, sure = block[part.end - base :], part.end, part.sure
        if not data:
            return


class _Order:
    """Puts the frames and gaps of a scan into the order of the file, block by block, and corrects their times."""

    def __init__(self) -> None:
        self._last: int | None = None
        """Time of the newest frame, us."""
        self._gap: Gap | None = None
        """A gap that may go on in the next block."""

    def sort(self, part: CarefulScan, *, final: bool) -> list[LogFrame | Gap]:
        """Return what a scan has found. The last gap of a block follows with the next one, unless it is `final`."""
        frames, done = part.frames, 0
        found: list[LogFrame | Gap] = []
        for gap in chain(part.damage, [Gap(part.end, part.tail)] if part.tail else []):
            before = next((at for at in range(done, len(frames)) if frames[at].at > gap.offset), len(frames))
            self._add_frames(found, frames[done:before])
            joined = self._gap
            self._gap = gap if joined is None else Gap(joined.offset, joined.size + gap.size)
            done = before
        self._add_frames(found, frames[done:])
        if final:
            self._end_gap(found)
        return found

    def _end_gap(self, found: list[LogFrame | Gap]) -> bool:
        if self._gap is None:
            return False
        found.append(self._gap)
        self._gap = None
        return True

    def _add_frames(self, found: list[LogFrame | Gap], frames: list[LogFrame]) -> None:
        """Add frames. One behind damage, which may reach its time, must be within a day of the time before."""
        resumed, last = bool(frames) and self._end_gap(found), self._last
        for frame in frames:
            stamp = frame.stamp
            if stamp > LATEST or (resumed and last is not None and not last <= stamp <= last + _DAY):
                frame, stamp = frame._replace(stamp=last or 0), last or 0
            found.append(frame)
            last, resumed = stamp, False
        self._last = last
