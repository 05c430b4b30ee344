"""Scans a block of a telemetry log: every whole frame with its place, and what is damaged. Nothing raises.

The careful scan checks each checksum and finds the next valid record behind damage. All that reads logs uses it. The
fast scan, for an index only, follows the lengths in the headers and looks at no checksum; it gives up where a record
does not fit.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Set as AbstractSet
from typing import NamedTuple

import msgspec
from fastcrc.crc16 import mcrf4xx

from dialects.codec import CRC_EXTRA, CRC_SIZE, HEADER_V1, HEADER_V2, MAGIC_V1, MAGIC_V2
from link.protocol.frame import read_header

STAMP = 8
"""Bytes of the time before each frame."""

RAW_STREAM = "has frames without times, such as an .rlog or .raw: open the .tlog beside it"

MAX_RECORD = STAMP + 280
"""Bytes of the longest record: a signed MAVLink 2 frame with 255 bytes of payload."""

BEYOND = 2 * MAX_RECORD
"""Bytes that a scan needs behind its limit: the rest of the last record, and the start of the next one."""

_LEAST = STAMP + HEADER_V1 + CRC_SIZE
_FRAMING_V2 = HEADER_V2 + CRC_SIZE
_LEAST_V2 = STAMP + _FRAMING_V2
_STAMP = struct.Struct(">Q")
_HEAD = struct.Struct("<8xBBBxBBBHB")
"""Behind the stamp: start byte, length, incompatibility flags, sequence, system, component, the id in two parts."""
_MAGIC = re.compile(b"[\xfd\xfe]")
_MAGICS = (MAGIC_V1, MAGIC_V2)

SourceKey = bytes
"""System, component and the id's three bytes, as in a MAVLink 2 header; one byte of id in a MAVLink 1 frame."""


class LogFrame(NamedTuple):
    """A valid frame and where it stands."""

    at: int
    """Offset of its record in the file."""
    stamp: int
    """Unix time, us; not checked."""
    message_id: int
    system: int
    component: int
    sequence: int
    raw: bytes

    @property
    def end(self) -> int:
        """Offset behind the record."""
        return self.at + STAMP + len(self.raw)


class Gap(NamedTuple):
    """Bytes that belong to no valid record: damage, or a record that was not finished."""

    offset: int
    """Of the first byte in the file."""
    size: int


class CarefulScan(msgspec.Struct):
    """Result of scan()."""

    frames: list[LogFrame] = msgspec.field(default_factory=list)
    damage: list[Gap] = msgspec.field(default_factory=list)
    end: int = 0
    """Offset at which the next block starts."""
    sure: bool = True
    """A valid record ends there."""
    tail: int = 0
    """Bytes at the end of the file that are not a whole record: cut off, or still being written."""


class FastScan(msgspec.Struct):
    """Result of scan_fast()."""

    last: dict[SourceKey, int]
    """Key of a kind of message -> offset of its last record in the block."""
    found: list[int]
    """Offsets of the records whose key was wanted."""
    count: int
    end: int


def scan(  # noqa: C901 - calls cost more here
    block: bytes, base: int, limit: int, *, final: bool, sure: bool = True
) -> CarefulScan:
    """Scan the records that start before offset `limit`, checking each checksum.

    `block` has the bytes of the file from `base` to BEYOND behind `limit`, or to the end of the file (`final`).
    `sure`: a valid record ends at `base`.
    """
    result = CarefulScan()
    frames, new, size = result.frames, tuple.__new__, len(block)  # LogFrame(...) takes twice as long
    at, gap, stop, end = 0, -1, limit - base, 0
    while at < stop and at + _LEAST <= size:
        frame: LogFrame | None = None
        if at + _LEAST_V2 <= size:
            magic, length, flags, sequence, system, component, low, high = _HEAD.unpack_from(block, at)
            number = low | high << 16
            extra, end = CRC_EXTRA.get(number), at + _LEAST_V2 + length
            if extra is not None and magic == MAGIC_V2 and not flags and end <= size:
                raw = block[at + STAMP : end]
                if mcrf4xx(raw[1:-2] + extra) == raw[-2] | raw[-1] << 8:
                    (stamp,) = _STAMP.unpack_from(block, at)
                    frame = new(LogFrame, (base + at, stamp, number, system, component, sequence, raw))
        if frame is None:
            frame = frame_at(block, at, base, trust_unknown=sure and gap < 0, final=final)
            if frame is None:
                gap = at if gap < 0 else gap
                at = _next_start(block, at + 1)
                continue
            end = frame.end - base
        if gap >= 0:
            result.damage.append(Gap(base + gap, at - gap))
            gap = -1
        frames.append(frame)
        at, sure = end, True
    start = at if gap < 0 else gap
    if gap < 0 and at >= stop:
        result.end = base + at
    elif final and stop >= size:
        result.end, result.sure, result.tail = base + start, sure, size - start
    else:
        result.damage.append(Gap(base + start, stop - start))
        result.end, result.sure = limit, False
    return result


def _next_start(block: bytes, at: int) -> int:
    """Return where the next record may start."""
    found = _MAGIC.search(block, at + STAMP)
    return len(block) if found is None else found.start() - STAMP


def plain_frame_at(block: bytes, at: int, base: int) -> LogFrame | None:
    """Return the frame of the record at `at` if it is a valid one of MAVLink 2, unsigned, with an id that is known."""
    if at + _LEAST_V2 > len(block):
        return None
    magic, length, flags, sequence, system, component, low, high = _HEAD.unpack_from(block, at)
    number = low | high << 16
    extra, end = CRC_EXTRA.get(number), at + _LEAST_V2 + length
    if extra is None or magic != MAGIC_V2 or flags or end > len(block):
        return None
    raw = block[at + STAMP : end]
    if mcrf4xx(raw[1:-2] + extra) != raw[-2] | raw[-1] << 8:
        return None
    (stamp,) = _STAMP.unpack_from(block, at)
    return tuple.__new__(LogFrame, (base + at, stamp, number, system, component, sequence, raw))


def frame_at(block: bytes, at: int, base: int, *, trust_unknown: bool, final: bool) -> LogFrame | None:
    """Return the frame of the record at `at`; one with an unknown id only where a record ends and another follows."""
    start = at + STAMP
    if block[start] not in _MAGICS:
        return None
    header = read_header(block[start : start + _FRAMING_V2])
    if header is None or start + header.size > len(block):
        return None
    number, system, component, sequence, size = header
    raw, extra = block[start : start + size], CRC_EXTRA.get(number)
    if extra is None:
        following = start + size + STAMP
        ends = final if following >= len(block) else block[following] in _MAGICS
        if not trust_unknown or not ends:
            return None
    else:
        end = raw[1] + (HEADER_V2 if raw[0] == MAGIC_V2 else HEADER_V1)
        if mcrf4xx(raw[1:end] + extra) != raw[end] | raw[end + 1] << 8:
            return None
    (stamp,) = _STAMP.unpack_from(block, at)
    return LogFrame(base + at, stamp, number, system, component, sequence, raw)


def scan_fast(block: bytes, base: int, limit: int, wanted: AbstractSet[SourceKey]) -> FastScan | None:
    """Follow the headers of records that start before `limit`; None where one does not fit: scan carefully then.

    Arguments as for scan(). Only the last record's checksum is checked. A simple loop without calls: 50 MB/s.
    """
    last: dict[SourceKey, int] = {}
    found: list[int] = []
    at = before = count = 0
    stop = limit - base
    most = min(stop, len(block) - STAMP - HEADER_V2)
    while at < most:
        magic = block[at + 8]
        if magic == MAGIC_V2:
            length, flags = block[at + 9], block[at + 10]
            key = block[at + 13 : at + 18]
            step = length + 20 if not flags else length + 33
            if flags > 1:
                return None
        elif magic == MAGIC_V1:
            key = block[at + 11 : at + 14]
            step = block[at + 9] + 16
        else:
            return None
        last[key] = at
        if key in wanted:
            found.append(base + at)
        before, at, count = at, at + step, count + 1
    if at < stop or at > len(block) or not count or not _is_valid(block, before, base):
        return None
    return FastScan({key: base + offset for key, offset in last.items()}, found, count, base + at)


def _is_valid(block: bytes, at: int, base: int) -> bool:
    return frame_at(block, at, base, trust_unknown=True, final=True) is not None


FLIGHT_LOGS = {
    b"ULog\x01\x12\x35": "is a flight log of PX4 (ULog), no telemetry log (.tlog): PlotJuggler opens it",
    b"\xa3\x95\x80": "is a flight log of ArduPilot (DataFlash), no telemetry log (.tlog): MAVExplorer opens it",
}
"""First bytes -> what the file is. https://docs.px4.io/main/en/dev_log/ulog_file_format.html; AP_Logger/LogStructure.h:
HEAD_BYTE1, HEAD_BYTE2, LOG_FORMAT_MSG."""


def foreign_log(start: bytes) -> str:
    """Return what a file that starts so is, if it is a log of another format; "" for any other."""
    if is_raw_stream(start):
        return RAW_STREAM
    return next((text for head, text in FLIGHT_LOGS.items() if start.startswith(head)), "")


def is_raw_stream(start: bytes) -> bool:
    """Return whether a file that starts so has frames without times: .rlog of Mission Planner, .tlog.raw of MAVProxy.

    The first byte of a time is 0 until 2250.
    """
    return bool(scan(bytes(STAMP) + start[:MAX_RECORD], 0, 1, final=True).frames)


def stamp_at(block: bytes, at: int) -> int | None:
    """Return the stamp at a position of a block; None where it ends before."""
    return None if at + STAMP > len(block) else int(_STAMP.unpack_from(block, at)[0])


def key_of(frame: LogFrame) -> SourceKey:
    """Return the key of a frame as the fast scan forms it."""
    if frame.raw[0] == MAGIC_V2:
        return frame.raw[5:10]
    return frame.raw[3:6]


def id_of(key: SourceKey) -> int:
    """Return the message id of a key."""
    return int.from_bytes(key[2:], "little")
