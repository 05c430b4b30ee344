"""Reassembly of a file from pieces: what has arrived, what is missing, what to request next."""

from __future__ import annotations

import bisect
import itertools
from collections.abc import Iterator


class RangeSet:
    """A set of offsets, stored as ranges that neither touch nor overlap."""

    def __init__(self) -> None:
        self._starts: list[int] = []
        self._ends: list[int] = []

    @property
    def end(self) -> int:
        """One past the last offset; 0 if the set is empty."""
        return self._ends[-1] if self._ends else 0

    @property
    def bytes(self) -> int:
        """Number of offsets in the set."""
        return sum(self._ends) - sum(self._starts)

    def add(self, start: int, end: int) -> None:
        """Add the offsets from `start` to `end` (excluded)."""
        if start >= end:
            return
        first = bisect.bisect_left(self._ends, start)  # the first range that touches `start` or lies behind it
        after = bisect.bisect_right(self._starts, end)
        if first < after:
            start, end = min(start, self._starts[first]), max(end, self._ends[after - 1])
        self._starts[first:after] = [start]
        self._ends[first:after] = [end]

    def gaps(self, end: int) -> Iterator[tuple[int, int]]:
        """Yield the ranges below `end` that are not in the set."""
        at = 0
        for start, stop in zip(self._starts, self._ends, strict=True):
            if start >= end:
                break
            if at < start:
                yield at, start
            at = stop
        if at < end:
            yield at, end


class FileReassembly:
    """A file in pieces, and the requests for missing ones."""

    def __init__(self, end: int) -> None:
        self.end = end
        """Upper bound of the file's length."""
        self.received = RangeSet()
        self._data = bytearray()
        self._requested: dict[int, tuple[int, float]] = {}

    @property
    def data(self) -> bytes:
        """The file; zeros where something is missing."""
        return bytes(self._data[: self.end])

    @property
    def beginning(self) -> bytes:
        """What arrived without a gap from the start."""
        gap = next(self.received.gaps(self.end), None)
        return bytes(self._data[: self.end if gap is None else gap[0]])

    @property
    def complete(self) -> bool:
        """Whether the whole file has arrived."""
        return next(self.received.gaps(self.end), None) is None

    def add_piece(self, offset: int, data: bytes) -> None:
        """Store a piece; one that reaches beyond the end is not of this file."""
        end = offset + len(data)
        if end <= self.end:
            self._data.extend(bytes(max(0, end - len(self._data))))
            self._data[offset:end] = data
            self.received.add(offset, end)

    def truncate(self, offset: int) -> None:
        """Shorten the file: there is nothing at `offset`."""
        self.end = min(self.end, offset)

    def mark_requested(self, key: int, offset: int, due: float) -> None:
        """Record a request for the piece at `offset`; its reply has `key` and is overdue at `due`."""
        self._requested[key] = (offset, due)

    def pop_request(self, key: int) -> int | None:
        """Remove and return the offset that was requested under `key`."""
        return self._requested.pop(key, (None, 0.0))[0]

    def expire_requests(self, now: float) -> bool:
        """Forget overdue requests, so that their pieces are requested again; return whether there were any."""
        before = len(self._requested)
        self._requested = {key: request for key, request in self._requested.items() if now < request[1]}
        return len(self._requested) < before

    def next_due(self, default: float) -> float:
        """Return when the first reply is overdue."""
        return min((due for _, due in self._requested.values()), default=default)

    def next_missing(self, window: int, size: int) -> list[tuple[int, int]]:
        """Return offset and length of the next pieces to request, so that `window` are under way."""
        under_way = {offset for offset, _ in self._requested.values()}
        pieces = (
            (offset, min(size, end - offset))
            for start, end in self.received.gaps(self.end)
            for offset in range(start, end, size)
        )
        first = itertools.islice(pieces, window)
        return [piece for piece in first if piece[0] not in under_way][: window - len(under_way)]
