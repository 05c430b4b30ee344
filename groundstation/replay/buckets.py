"""Values over the time of a whole log in a bounded number of buckets, for the timeline."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable

MAX_BUCKETS = 4096
"""More than any terminal has columns of dots."""

FIRST_STEP = 0.1
"""s of a bucket at first; it doubles when the log grows longer than the buckets."""


class Buckets:
    """One number for each step of time: the largest of the values in it, or their sum."""

    def __init__(self, join: Callable[[float, float], float] = max) -> None:
        self._join = join
        self._values = array("d")
        self._step = FIRST_STEP

    def add(self, at: float, value: float) -> None:
        """Add a value at a time, s since the start."""
        while (number := int(at / self._step)) >= MAX_BUCKETS:
            self._halve()
        while len(self._values) <= number:
            self._values.append(math.nan)
        before = self._values[number]
        self._values[number] = value if math.isnan(before) else self._join(before, value)

    def _halve(self) -> None:
        pairs = zip(self._values[::2], [*self._values[1::2], math.nan], strict=False)
        self._values = array("d", (self._both(first, second) for first, second in pairs))
        self._step *= 2

    def _both(self, first: float, second: float) -> float:
        if math.isnan(first) or math.isnan(second):
            return second if math.isnan(first) else first
        return self._join(first, second)

    def columns(self, count: int, end: float) -> tuple[float | None, ...]:
        """Return the value of each of `count` equal parts of the time from 0 to `end`; None where there is none."""
        if end <= 0:
            return (None,) * count
        return tuple(self._column(end * column / count, end * (column + 1) / count) for column in range(count))

    def _column(self, start: float, end: float) -> float | None:
        """Return the value of a part; one that is shorter than a bucket has that of its bucket."""
        first = int(start / self._step)
        value = math.nan
        for number in range(first, min(len(self._values), max(first + 1, math.ceil(end / self._step)))):
            value = self._both(value, self._values[number])
        return None if math.isnan(value) else value
