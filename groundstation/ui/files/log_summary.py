"""What a telemetry log holds, at a glance: how long it is, and of which vehicles. Reads its two ends only.

The screen's process does not load the dialect, so that frames are told by their headers alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import msgspec

HEAD, TAIL = 64 * 1024, 8 * 1024
"""Bytes that are read at the beginning and at the end."""
STAMP = 8
"""Bytes of the time before each frame, us since 1970, big-endian."""
LARGEST = STAMP + 293
"""Bytes of a record with the largest frame, which is signed."""
LONGEST = 10 * 86_400.0
"""s; a longer log has a damaged time."""
LATEST = 4_102_444_800.0
"""s since 1970: the year 2100. What has a later time is no log."""
_V1, _V2, _SIGNED = 0xFE, 0xFD, 1
_GCS, _NO_AUTOPILOT = 6, 8
"""MAV_TYPE of a ground station, and MAV_AUTOPILOT of what is no vehicle."""


class LogSummary(msgspec.Struct, frozen=True):
    """A telemetry log."""

    length: float | None
    """s from the first record to the last; None: the end is damaged."""
    systems: tuple[int, ...] = ()
    """Ids of the vehicles whose HEARTBEAT is in the beginning."""


def read_summary(path: Path) -> LogSummary | None:
    """Return the summary of a file; None if it cannot be read or is no telemetry log."""
    try:
        with path.open("rb") as file:
            head = file.read(HEAD)
            size = file.seek(0, 2)
            file.seek(max(0, size - TAIL))
            return summarize(head, file.read(TAIL))
    except OSError:
        return None


def summarize(head: bytes, tail: bytes) -> LogSummary | None:
    """Return the summary of a log with this beginning and end; None if it does not begin with a record."""
    records = list(_records(head, 0))
    if not records or _stamp(head, 0) > LATEST:
        return None
    begun, ended = _stamp(head, 0), _last_stamp(tail)
    length = None if ended is None or not 0 <= ended - begun <= LONGEST else ended - begun
    return LogSummary(length, tuple(sorted({found for at in records if (found := _vehicle(head, at + STAMP))})))


def _records(data: bytes, at: int) -> Iterator[int]:
    """Yield where the whole records are that follow each other from `at` on."""
    while size := _frame_size(data, at + STAMP):
        if at + STAMP + size > len(data):
            return
        yield at
        at += STAMP + size


def _frame_size(data: bytes, at: int) -> int:
    """Return the size of the frame that begins there; 0 if none does."""
    if at + 3 > len(data) or data[at] not in (_V1, _V2):
        return 0
    if data[at] == _V1:
        return 8 + int(data[at + 1])
    return 12 + int(data[at + 1]) + (13 if data[at + 2] & _SIGNED else 0)


def _last_stamp(tail: bytes) -> float | None:
    """Return the time of the last record: that of the first chain of records which reaches the end."""
    for start in range(len(tail)):
        last, end = None, start
        for at in _records(tail, start):
            last, end = at, at + STAMP + _frame_size(tail, at + STAMP)
        if last is not None and len(tail) - end < LARGEST and (last > start or end == len(tail)):
            return _stamp(tail, last)
    return None


def _stamp(data: bytes, at: int) -> float:
    return int.from_bytes(data[at : at + STAMP], "big") / 1e6


def _vehicle(data: bytes, at: int) -> int:
    """Return the system id of the HEARTBEAT of a vehicle; 0 for any other frame."""
    v2 = data[at] == _V2
    payload = data[at + (10 if v2 else 6) :][: data[at + 1]].ljust(9, b"\0")
    message = int.from_bytes(data[at + 7 : at + 10], "little") if v2 else data[at + 5]
    if message != 0 or payload[4] == _GCS or payload[5] == _NO_AUTOPILOT:
        return 0
    return data[at + (5 if v2 else 3)]
