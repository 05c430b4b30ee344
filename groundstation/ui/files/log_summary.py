"""What a telemetry log holds, at a glance: how long it is, of which vehicles, for how long they were armed and drove.

Reads its two ends and, of a large one, samples at equal steps between them.

The screen's process does not load the dialect, so that frames are told by their headers alone.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import BinaryIO

import msgspec

HEAD, TAIL = 64 * 1024, 8 * 1024
"""Bytes that are read at the beginning and at the end."""
SAMPLES, SAMPLE = 256, 8 * 1024
"""Places in a log, and bytes that are read at each: a second or more of usual telemetry."""
STAMP = 8
"""Bytes of the time before each frame, us since 1970, big-endian."""
LARGEST = STAMP + 293
"""Bytes of a record with the largest frame, which is signed."""
LONGEST = 10 * 86_400.0
"""s; a longer log has a damaged time."""
LATEST = 4_102_444_800.0
"""Unix time of the year 2100; a later timestamp is not from a log."""
_SPEED = struct.Struct("<f")
_V1, _V2, _SIGNED = 0xFE, 0xFD, 1
_HEARTBEAT, _VFR_HUD = 0, 74
_SAFETY_ARMED = 0x80
DRIVES = 0.1
"""m/s from which on a vehicle drives."""
SHORT = 30.0
"""s; a shorter log in which nothing was armed is the start of a program, and no drive."""
_GCS, _NO_AUTOPILOT = 6, 8
"""MAV_TYPE of a ground station, and MAV_AUTOPILOT of what is not a vehicle."""


class LogSummary(msgspec.Struct, frozen=True):
    """A telemetry log."""

    length: float | None
    """s from the first record to the last; None: the end is damaged."""
    systems: tuple[int, ...] = ()
    """Ids of the vehicles whose HEARTBEAT is in the beginning."""
    armed: float | None = None
    """s for which a vehicle was armed, about; None: not known."""
    driven: float | None = None
    """s for which one drove, about."""

    @property
    def is_start(self) -> bool:
        """Nothing was armed, and it is short: a program was started and ended again."""
        return self.armed == 0 and self.length is not None and self.length < SHORT


def read_summary(path: Path) -> LogSummary | None:
    """Return the summary of a file; None if it cannot be read or is not a telemetry log."""
    try:
        with path.open("rb") as file:
            head = file.read(HEAD)
            size = file.seek(0, 2)
            file.seek(max(0, size - TAIL))
            found = summarize(head, file.read(TAIL))
            if found is None or found.length is None:
                return found
            return _count(found, _read_samples(file, size))
    except OSError:
        return None


def _read_samples(file: BinaryIO, size: int) -> Iterator[bytes]:
    """Yield a file in pieces, of a large one samples at equal steps."""
    step = max(SAMPLE, size // SAMPLES)
    for at in range(0, size, step):
        file.seek(at)
        yield file.read(min(step, SAMPLE) + LARGEST)


def _count(found: LogSummary, samples: Iterable[bytes]) -> LogSummary:
    """Return a summary with the times armed and driven: the shares of the samples in which that was so."""
    heartbeats, armed, speeds, driven = 0, 0, 0, 0
    for data in samples:
        for at in _chain(data):
            message, payload = _message(data, at + STAMP)
            if message == _HEARTBEAT and _vehicle(data, at + STAMP):
                heartbeats += 1
                armed += bool(payload[6] & _SAFETY_ARMED)
            elif message == _VFR_HUD:
                speeds += 1
                driven += _SPEED.unpack_from(payload, 4)[0] >= DRIVES
    length = found.length or 0.0
    return LogSummary(found.length, found.systems,
                      length * armed / heartbeats if heartbeats else None,
                      length * driven / speeds if speeds else None)  # fmt: skip


def _chain(data: bytes) -> Iterator[int]:
    """Yield the records of the first chain of two or more in a sample, which may begin within one."""
    for start in range(min(len(data), LARGEST)):
        records = _records(data, start)
        first, second = next(records, None), next(records, None)
        if first is not None and second is not None:
            yield first
            yield second
            yield from records
            return


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


def _message(data: bytes, at: int) -> tuple[int, bytes]:
    """Return the id of a message, and its payload with the zeros that MAVLink 2 leaves out."""
    v2 = data[at] == _V2
    begin = at + (10 if v2 else 6)
    payload = data[begin : begin + data[at + 1]].ljust(20, b"\0")
    return (int.from_bytes(data[at + 7 : at + 10], "little") if v2 else data[at + 5]), payload


def _vehicle(data: bytes, at: int) -> int:
    """Return the system id of the HEARTBEAT of a vehicle; 0 for any other frame."""
    message, payload = _message(data, at)
    if message != _HEARTBEAT or payload[4] == _GCS or payload[5] == _NO_AUTOPILOT:
        return 0
    return data[at + (5 if data[at] == _V2 else 3)]
