"""Transmit queue of a slow link: urgent frames overtake telemetry. Sans-IO.

Urgent frames (dialects/traits.py) go before bulk, each class in its own order. Of urgent state, e.g. demands and
heartbeats, only the newest waits. When bulk is full its oldest frame is dropped. A frame that has waited longer than
STALE is dropped, because an old demand is a wrong one; a stop is never dropped for its age.
"""

from __future__ import annotations

from collections import deque

from dialects import codec
from dialects.targets import target_of
from dialects.traits import COMMANDS, NEWEST_ONLY, URGENT, is_stop
from link.protocol.frame import read_header

STALE = 0.5
"""s after which a waiting frame does more harm than good: about as long as the vehicle uses a demand (0.45 s)."""
MAX_URGENT = 64
"""Urgent frames that may wait: 0.4 s of them at 57600 baud."""
MAX_DRIVER_BACKLOG = 0.020
"""s of transmission time that may lie in the driver's buffer, where nothing can overtake."""
MIN_DRIVER_BACKLOG = 0.004
"""s: below this any frame may go, however long it is, or the line would idle."""


class _Entry:
    __slots__ = ("at", "data", "key")

    def __init__(self, data: bytes, at: float, key: tuple[int, ...] | None) -> None:
        self.data = data
        self.at = at
        self.key = key


class TransmitQueue:
    """Frames that wait for one transport. `limit` is how many bytes of bulk may wait."""

    def __init__(self, limit: int) -> None:
        self.dropped = 0
        """Frames dropped."""
        self._limit = limit
        self._urgent: deque[_Entry] = deque()
        self._bulk: deque[_Entry] = deque()
        self._bulk_size = 0
        self._newest: dict[tuple[int, ...], _Entry] = {}

    def push(self, data: bytes, now: float) -> None:
        """Add one whole frame."""
        header = read_header(data)
        if header is None or header.message_id not in URGENT:
            self._put_bulk(data, now)
        elif header.message_id in NEWEST_ONLY:
            target = target_of(header.message_id, data)
            self._put_newest(data, now, (header.message_id, header.system, header.component, *target))
        else:
            self._put_urgent(_Entry(data, now, None))

    def next_size(self, now: float) -> int:
        """Return the bytes of the frame that goes next; 0 when none waits."""
        while self._urgent and self._is_stale(self._urgent[0], now):
            self._give_up(self._urgent.popleft())
        if self._urgent:
            return len(self._urgent[0].data)
        while self._bulk and self._is_stale(self._bulk[0], now):
            self._drop_bulk()
        return len(self._bulk[0].data) if self._bulk else 0

    def pop(self, now: float) -> bytes:
        """Remove and return the frame that goes next; empty when none waits."""
        if not self.next_size(now):
            return b""
        if self._urgent:
            entry = self._urgent.popleft()
            if entry.key is not None:
                del self._newest[entry.key]
            return entry.data
        entry = self._bulk.popleft()
        self._bulk_size -= len(entry.data)
        return entry.data

    def clear(self) -> None:
        """Drop all that waits, after a disconnect."""
        self._urgent.clear()
        self._bulk.clear()
        self._newest.clear()
        self._bulk_size = 0

    def _put_bulk(self, data: bytes, now: float) -> None:
        self._bulk.append(_Entry(data, now, None))
        self._bulk_size += len(data)
        while self._bulk_size > self._limit:
            self._drop_bulk()

    def _put_newest(self, data: bytes, now: float, key: tuple[int, ...]) -> None:
        waiting = self._newest.get(key)
        if waiting is not None:
            waiting.data, waiting.at = data, now  # keeps its place in the queue
            self.dropped += 1
            return
        entry = self._newest[key] = _Entry(data, now, key)
        self._put_urgent(entry)

    def _put_urgent(self, entry: _Entry) -> None:
        self._urgent.append(entry)
        if len(self._urgent) > MAX_URGENT:
            leaving = next((each for each in self._urgent if not _stops(each.data)), self._urgent[0])
            self._urgent.remove(leaving)
            self._give_up(leaving)

    def _drop_bulk(self) -> None:
        self._bulk_size -= len(self._bulk.popleft().data)
        self.dropped += 1

    def _give_up(self, entry: _Entry) -> None:
        if entry.key is not None:
            del self._newest[entry.key]
        self.dropped += 1

    def _is_stale(self, entry: _Entry, now: float) -> bool:
        return now - entry.at > STALE and not _stops(entry.data)


def _stops(data: bytes) -> bool:
    """Return whether this frame holds a command that only stops."""
    header = read_header(data)
    if header is None or header.message_id not in COMMANDS:
        return False
    start = codec.HEADER_V2 if data[0] == codec.MAGIC_V2 else codec.HEADER_V1
    return is_stop(codec.decode(header.message_id, data[start : start + data[1]]))


class TransmitPacer:
    """Paces a line of `capacity` bytes/s, so that no long queue forms in the driver."""

    def __init__(self, capacity: float) -> None:
        self._capacity = capacity
        self._free_at = 0.0
        """When the line will have sent what was written."""

    def delay(self, size: int, in_driver: int, now: float) -> float:
        """Return the s until a frame of `size` bytes may go; `in_driver` bytes wait there (0: not known)."""
        ahead = max(self._free_at - now, in_driver / self._capacity)
        return max(0.0, min(ahead + size / self._capacity - MAX_DRIVER_BACKLOG, ahead - MIN_DRIVER_BACKLOG))

    def record_written(self, size: int, now: float) -> None:
        """Record that `size` bytes went to the driver."""
        self._free_at = max(self._free_at, now) + size / self._capacity
