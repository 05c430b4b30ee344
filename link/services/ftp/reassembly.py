"""A file that arrives in pieces: which bytes are here, which are missing, and which to ask for next."""

from __future__ import annotations

import bisect
import itertools
from collections.abc import Iterator


class RangeSet:
    """A set of offsets, kept as ranges that neither touch nor overlap."""

    def __init__(self) -> None:
        self._starts: list[int] = []
        self._ends: list[int] = []

    @property
    def end(self) -> int:
        """One past the last byte that is here; 0 when nothing is."""
        return self._ends[-1] if self._ends else 0

    @property
    def bytes(self) -> int:
        """How many are here."""
        return sum(self._ends) - sum(self._starts)

    def add(self, start: int, end: int) -> None:
        """The bytes from `start` to `end` (not included) are here."""
        if start >= end:
            return
        first = bisect.bisect_left(self._ends, start)  # the first range that `start` touches or that lies behind it
        after = bisect.bisect_right(self._starts, end)
        if first < after:
            start, end = min(start, self._starts[first]), max(end, self._ends[after - 1])
        self._starts[first:after] = [start]
        self._ends[first:after] = [end]

    def gaps(self, end: int) -> Iterator[tuple[int, int]]:
        """The ranges below `end` that are not here."""
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
    """A file in pieces: what has come, what is missing, and which of that was asked for lately."""

    def __init__(self, end: int) -> None:
        self.end = end
        """The file is not longer than this."""
        self.received = RangeSet()
        self._data = bytearray()
        self._asked: dict[int, tuple[int, float]] = {}

    @property
    def data(self) -> bytes:
        """The file; zeros where something is missing."""
        return bytes(self._data[: self.end])

    @property
    def complete(self) -> bool:
        """Is all of it here?"""
        return next(self.received.gaps(self.end), None) is None

    def add_piece(self, offset: int, data: bytes) -> None:
        """Keep a piece; one that reaches beyond the end is none of this file."""
        end = offset + len(data)
        if end <= self.end:
            self._data.extend(bytes(max(0, end - len(self._data))))
            self._data[offset:end] = data
            self.received.add(offset, end)

    def truncate(self, offset: int) -> None:
        """There is nothing at `offset`: the file was shorter than it was said to be."""
        self.end = min(self.end, offset)

    def mark_requested(self, key: int, offset: int, due: float) -> None:
        """The piece at `offset` was asked for; its answer will bear `key` and is overdue at `due`."""
        self._asked[key] = (offset, due)

    def pop_request(self, key: int) -> int | None:
        """The offset that was asked for under `key`, once."""
        return self._asked.pop(key, (None, 0.0))[0]

    def expire_requests(self, now: float) -> bool:
        """Pieces that did not come may be asked for again; True when there was one."""
        before = len(self._asked)
        self._asked = {key: asked for key, asked in self._asked.items() if now < asked[1]}
        return len(self._asked) < before

    def next_due(self, default: float) -> float:
        """When the first answer is overdue."""
        return min((due for _, due in self._asked.values()), default=default)

    def next_missing(self, window: int, size: int) -> list[tuple[int, int]]:
        """Offset and length of the first missing pieces that are not asked for, so that `window` are under way."""
        under_way = {offset for offset, _ in self._asked.values()}
        pieces = (
            (offset, min(size, end - offset))
            for start, end in self.received.gaps(self.end)
            for offset in range(start, end, size)
        )
        first = itertools.islice(pieces, window)
        return [piece for piece in first if piece[0] not in under_way][: window - len(under_way)]
