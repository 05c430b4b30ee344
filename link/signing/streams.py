"""The newest timestamp of each stream of signed frames, so that none is accepted twice.

A stream is a key, a system, a component and a link id. The key belongs to it, so that the holder of one key cannot lock
out that of another with timestamps of the future. Only correctly signed frames reach this table.

The table has MAX_STREAMS places. When it is full, the key with the most streams loses the one whose newest timestamp is
the oldest, and from then on this key begins no stream at or before that timestamp: what was accepted once is never
accepted again, and a key with few streams loses none to a key that opens many.

A timestamp of years ahead would end a stream for good. Once the right time is known, such a stream goes back to it
(`heal`), and the timestamps before its newest one are refused for ever.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import NamedTuple

MAX_STREAMS = 64
MAX_SPANS = 16
"""Spans of timestamps that are refused for ever; of more the oldest are forgotten."""
SPAN = 30 * 86_400 * 100_000
"""Length of a span: 30 days. A clock that is years ahead is set right before long."""


class SignedStream(NamedTuple):
    """Who sends, over which link, with which key."""

    key: str
    """Fingerprint."""
    system: int
    component: int
    link_id: int


class Span(NamedTuple):
    """Timestamps of one key that are refused for ever, because its clock was years ahead when it used them."""

    key: str
    """Fingerprint."""
    after: int
    until: int


class StreamTable:
    """Newest timestamp of each stream."""

    def __init__(
        self,
        newest: Mapping[SignedStream, int] | None = None,
        floors: Mapping[str, int] | None = None,
        spans: Iterable[Span] = (),
    ) -> None:
        self.newest: dict[SignedStream, int] = {}
        self.stored: set[SignedStream] = set()
        """Those of the last run that have brought nothing in this one."""
        self._counts: Counter[str] = Counter()
        self.floors: dict[str, int] = dict(floors or {})
        """Fingerprint -> the newest timestamp of the streams that lost their place."""
        self.spans: list[Span] = list(spans)
        """Oldest first."""
        for stream, stamp in (newest or {}).items():
            self.record(stream, stamp)
        self.stored.update(self.newest)

    def is_replay(self, stream: SignedStream, stamp: int) -> bool:
        """Return whether a timestamp is not newer than all of its stream."""
        last = self.newest.get(stream)
        if stamp <= (self.floors.get(stream.key, -1) if last is None else last):
            return True
        return bool(self.spans) and any(
            each.after < stamp <= each.until for each in self.spans if each.key == stream.key
        )

    def newest_of(self, key: str) -> int:
        """Return the newest timestamp of a key; -1 if there is none."""
        stamps = (stamp for stream, stamp in self.newest.items() if stream.key == key)
        return max(max(stamps, default=-1), self.floors.get(key, -1))

    def heal(self, right: int, limit: int) -> None:
        """Set the streams whose newest timestamp is more than `limit` ahead of the `right` time back to that time."""
        for stream, stamp in self.newest.items():
            if stamp > right + limit:
                self._add_span(stream.key, right + limit, stamp)
                self.newest[stream] = right
        for key, stamp in self.floors.items():
            if stamp > right + limit:
                self._add_span(key, right + limit, stamp)
                self.floors[key] = right

    def _add_span(self, key: str, least: int, until: int) -> None:
        after = max(least, until - SPAN)
        kept = [each for each in self.spans if each.key != key or each.until < after or until < each.after]
        joined = [each for each in self.spans if each not in kept]
        after, until = min([after, *(each.after for each in joined)]), max([until, *(each.until for each in joined)])
        self.spans = [*kept, Span(key, after, until)][-MAX_SPANS:]

    def record(self, stream: SignedStream, stamp: int) -> None:
        """Note the newest timestamp of a stream."""
        if stream not in self.newest:
            if len(self.newest) >= MAX_STREAMS:
                self._evict()
            self._counts[stream.key] += 1
        self.newest[stream] = stamp
        self.stored.discard(stream)

    def is_running(self, stream: SignedStream) -> bool:
        """Return whether a stream has brought a frame in this run."""
        return stream in self.newest and stream not in self.stored

    def keep_keys(self, fingerprints: Iterable[str]) -> None:
        """Forget the streams of all other keys."""
        kept = set(fingerprints)
        self.newest = {stream: stamp for stream, stamp in self.newest.items() if stream.key in kept}
        self.floors = {key: stamp for key, stamp in self.floors.items() if key in kept}
        self.spans = [each for each in self.spans if each.key in kept]
        self._counts = Counter(stream.key for stream in self.newest)

    def _evict(self) -> None:
        key = max(self._counts, key=self._counts.__getitem__)
        stamp, oldest = min((stamp, each) for each, stamp in self.newest.items() if each.key == key)
        del self.newest[oldest]
        self._counts[key] -= 1
        self.floors[key] = max(self.floors.get(key, 0), stamp)
