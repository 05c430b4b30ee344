"""Columns: the points of a line by columns of dots, so that a picture costs its width and not its points."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right

import msgspec

from groundstation.ui.charts.points import Points


class DotColumn(msgspec.Struct):
    """The points in one column of dots."""

    number: int
    """Time divided by the width of a column."""
    first: float
    low: float
    high: float
    last: float
    broken: bool
    """Data stopped before its first point: no line leads to it."""


class Columns:
    """Columns of `step` s each, numbered by their time, so that they stay as they are while time goes on."""

    def __init__(self, step: float) -> None:
        self.step = step
        self._columns: list[DotColumn] = []
        self._points: Points | None = None
        self._done = 0
        self._begin = -math.inf
        """Time from which on points are columns."""

    def update(self, points: Points, begin: float = -math.inf) -> None:
        """Add the points that are new. Those long before `begin` are left out until it is earlier."""
        if points is not self._points or begin < self._begin:
            self._points, self._columns, self._begin = points, [], begin
            before = max(0, bisect_left(points.times, begin) - 1)  # the line to the left edge begins there
            self._done = points.dropped + before
        for index in range(max(self._done - points.dropped, 0), len(points.times)):
            self._add(int(points.times[index] // self.step), points.values[index], broken=bool(points.breaks[index]))
        self._done = points.count
        first = int(points.times[0] // self.step) if points.times else 0
        if self._columns and self._columns[0].number < first - 500:
            self._columns = [column for column in self._columns if column.number >= first]

    def between(self, left: int, right: int) -> list[DotColumn]:
        """Return the columns from `left` to `right`, and the one before them, from which a line comes."""
        first = bisect_left(self._columns, left, key=lambda column: column.number)
        last = bisect_right(self._columns, right, key=lambda column: column.number)
        return self._columns[max(0, first - 1) : last]

    def _add(self, number: int, value: float, *, broken: bool) -> None:
        last = self._columns[-1] if self._columns else None
        if last is None or number > last.number or broken:
            self._columns.append(DotColumn(number, value, value, value, value, broken))
            return
        last.low, last.high, last.last = min(last.low, value), max(last.high, value), value
