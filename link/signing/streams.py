"""The newest timestamp of each stream of signed frames, so that none is accepted twice.

A stream is a key, a system, a component and a link id. The key belongs to it, so that the holder of one key cannot lock
out that of another with timestamps of the future. Only correctly signed frames reach this table.

The table has MAX_STREAMS places. When it is full, the key with the most streams loses the one whose newest timestamp is
the oldest, and from then on this key begins no stream at or before that timestamp: what was accepted once is never
accepted again, and a key with few streams loses none to a key that opens many.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import NamedTuple

MAX_STREAMS = 64


class Stream(NamedTuple):
    """Who sends, over which link, with which key."""

    key: str
    """Fingerprint."""
    system: int
    component: int
    link_id: int


class StreamTable:
    """Newest timestamp of each stream."""

    def __init__(self, newest: Mapping[Stream, int] | None = None, floors: Mapping[str, int] | None = None) -> None:
        self.newest: dict[Stream, int] = {}
        self.stored: set[Stream] = set()
        """Those of the last run that have brought nothing in this one."""
        self._counts: Counter[str] = Counter()
        self.floors: dict[str, int] = dict(floors or {})
        """Fingerprint -> the newest timestamp of the streams that lost their place."""
        for stream, stamp in (newest or {}).items():
            self.record(stream, stamp)
        self.stored.update(self.newest)

    def is_replay(self, stream: Stream, stamp: int) -> bool:
        """Return whether a timestamp is not newer than all of its stream."""
        last = self.newest.get(stream)
        return stamp <= (self.floors.get(stream.key, -1) if last is None else last)

    def record(self, stream: Stream, stamp: int) -> None:
        """Note the newest timestamp of a stream."""
        if stream not in self.newest:
            if len(self.newest) >= MAX_STREAMS:
                self._evict()
            self._counts[stream.key] += 1
        self.newest[stream] = stamp
        self.stored.discard(stream)

    def is_running(self, stream: Stream) -> bool:
        """Return whether a stream has brought a frame in this run."""
        return stream in self.newest and stream not in self.stored

    def keep_keys(self, fingerprints: Iterable[str]) -> None:
        """Forget the streams of all other keys."""
        kept = set(fingerprints)
        self.newest = {stream: stamp for stream, stamp in self.newest.items() if stream.key in kept}
        self.floors = {key: stamp for key, stamp in self.floors.items() if key in kept}
        self._counts = Counter(stream.key for stream in self.newest)

    def _evict(self) -> None:
        key = max(self._counts, key=self._counts.__getitem__)
        stamp, oldest = min((stamp, each) for each, stamp in self.newest.items() if each.key == key)
        del self.newest[oldest]
        self.stored.discard(oldest)
        self._counts[key] -= 1
        self.floors[key] = max(self.floors.get(key, 0), stamp)
