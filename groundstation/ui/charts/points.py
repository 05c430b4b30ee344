"""Points: the times and values of one line, with the places where data stopped. PointStore: those of all fields."""

from __future__ import annotations

from array import array
from bisect import bisect_right
from collections.abc import Iterable

from groundstation.views.charts import FieldId, SeriesPage

SPAN = 600.0
"""s that are kept, as in the station."""

SPARE = 250
"""Points older than SPAN that are kept until they are removed together."""

LEAST_GAP, GAP_FACTOR = 1.5, 3.0
"""A pause is a gap if it is longer than LEAST_GAP s, and than GAP_FACTOR times the usual pause of the field."""

_ADAPTATION = 16
"""Pauses after which a new rate of a field counts as the usual one."""


class Points:
    """Times in s, values, and whether data stopped before a point."""

    def __init__(self) -> None:
        self.times, self.values, self.breaks = array("d"), array("d"), array("b")
        self.dropped = 0
        """Points that were removed at the front: the index of a point plus this never changes."""
        self._usual = 0.0

    @property
    def count(self) -> int:
        """Points since the beginning, also those that were removed."""
        return self.dropped + len(self.times)

    def add(self, at: float, value: float) -> None:
        """Add a point; finds out whether there is a gap before it."""
        pause = at - self.times[-1] if self.times else 0.0
        gap = pause > max(LEAST_GAP, GAP_FACTOR * self._usual) and bool(self._usual)
        if not gap:
            self._usual += (pause - self._usual) / (_ADAPTATION if self._usual else 1)
        self.add_known(at, value, gap=gap)

    def add_known(self, at: float, value: float, *, gap: bool) -> None:
        """Add a point whose gap is known."""
        self.times.append(at)
        self.values.append(value)
        self.breaks.append(gap)

    def forget(self, before: float) -> None:
        """Remove the points before a time, many at once."""
        old = bisect_right(self.times, before)
        if old >= SPARE:
            del self.times[:old], self.values[:old], self.breaks[:old]
            self.dropped += old

    def value_at(self, at: float) -> float | None:
        """Return the newest value at a time; None before the first point and in a gap."""
        index = bisect_right(self.times, at)
        if index == 0 or (index < len(self.times) and self.breaks[index] and at > self.times[index - 1]):
            return None
        ends = self.times[index - 1] + max(LEAST_GAP, GAP_FACTOR * self._usual)
        return self.values[index - 1] if index < len(self.times) or at <= ends else None

    @property
    def newest(self) -> float | None:
        """The last value."""
        return self.values[-1] if self.values else None


class PointStore:
    """The points of the fields that are drawn or pinned."""

    def __init__(self) -> None:
        self.fields: dict[FieldId, Points] = {}
        self.state = 0
        """Of the newest page."""
        self.now = 0.0
        """Station's clock at the newest page, s."""
        self.wall_offset = 0.0
        """Wall clock minus station's clock, s."""

    def keep(self, fields: Iterable[FieldId]) -> None:
        """Keep the points of these fields and no others."""
        self.fields = {field: self.fields.get(field) or Points() for field in fields}

    def add(self, page: SeriesPage) -> bool:
        """Add the points of a page; return False for one that does not follow the newest."""
        if page.after != self.state:
            return False
        self.state, self.now, self.wall_offset = page.state, page.now, page.wall - page.now
        for each in page.points:
            points = self.fields.get(each.field)
            if points is not None:
                for at, value in zip(array("d", each.times), array("d", each.values), strict=True):
                    points.add(at, value)
        for points in self.fields.values():
            points.forget(page.now - SPAN)
        return True
