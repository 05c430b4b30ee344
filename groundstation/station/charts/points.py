"""PointBuffer: the points of one field over the last minutes, in bounded memory."""

from __future__ import annotations

from array import array
from bisect import bisect_left, bisect_right
from collections.abc import Callable

import msgspec

SPAN = 600.0
"""s that are kept."""

SLOT = 0.2
"""s in which at most two points are kept, the lowest and the highest: a peak of 1 ms stays in the picture.

A field that arrives at 5 Hz or less is kept whole."""

SPARE = 250
"""Points older than SPAN that are kept until they are removed together."""

CAPACITY = 2 * (round(SPAN / SLOT) + 1) + SPARE
"""Points of one field at most: 6252, of 24 bytes each 150 kB. All 48 fields of a screen: 7 MB."""


class _Slot(msgspec.Struct):
    """The samples of one slot: the lowest and the highest, each with its time."""

    ends: float
    low_at: float
    low: float
    high_at: float
    high: float


class PointBuffer:
    """Times and values in the order of arrival. `count` gives the next number of a point; numbers only grow."""

    def __init__(self, count: Callable[[], int]) -> None:
        self._count = count
        self._times, self._values, self._numbers = array("d"), array("d"), array("q")
        self._slot: _Slot | None = None
        self._newest = float("-inf")

    def __len__(self) -> int:
        return len(self._times)

    def add(self, at: float, value: float) -> None:
        """Add a sample. A time before that of the newest sample counts as that one."""
        self._newest = at = max(at, self._newest)
        slot = self._slot
        if slot is not None and at < slot.ends:
            if value < slot.low:
                slot.low_at, slot.low = at, value
            elif value > slot.high:
                slot.high_at, slot.high = at, value
            return
        self._close()
        self._slot = _Slot(at + SLOT, at, value, at, value)

    def flush(self, now: float) -> None:
        """Add the points of a slot that has ended."""
        if self._slot is not None and now >= self._slot.ends:
            self._close()

    def take(self, after: int, limit: int) -> tuple[bytes, bytes]:
        """Return times and values of the points with numbers above `after`, up to `limit`, as 8-byte floats."""
        first, last = bisect_right(self._numbers, after), bisect_right(self._numbers, limit)
        return self._times[first:last].tobytes(), self._values[first:last].tobytes()

    def new_points(self, after: int, limit: int) -> int:
        """Return how many points `take` would return."""
        return bisect_right(self._numbers, limit) - bisect_right(self._numbers, after)

    def _close(self) -> None:
        slot, self._slot = self._slot, None
        if slot is None:
            return
        points = sorted({(slot.low_at, slot.low), (slot.high_at, slot.high)})
        for at, value in points:
            self._times.append(at)
            self._values.append(value)
            self._numbers.append(self._count())
        old = bisect_left(self._times, self._newest - SPAN)
        if old >= SPARE:
            del self._times[:old], self._values[:old], self._numbers[:old]
