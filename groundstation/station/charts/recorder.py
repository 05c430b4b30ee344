"""SeriesRecorder: records the fields that are drawn or pinned, and sends a screen what is new."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Mapping
from itertools import count

from groundstation.station.charts.marks import MarkList
from groundstation.station.charts.points import PointBuffer
from groundstation.views.charts import MAX_FIELDS, FieldId, SeriesPage, SeriesPoints, SeriesRequest

PAGE = 6000
"""Points and marks in one page: 100 kB, less than half a packet."""


class SeriesRecorder:
    """Points of all recorded fields and marks, numbered together in the order of their arrival."""

    def __init__(self) -> None:
        self._newest = 0
        numbers = count(1)

        def take_number() -> int:
            self._newest = next(numbers)
            return self._newest

        self._take_number = take_number
        self.marks = MarkList(take_number)
        self._buffers: dict[FieldId, PointBuffer] = {}
        self._drawn: tuple[FieldId, ...] = ()
        self.was_asked = False
        """A screen has drawn fields."""
        self._pinned: tuple[FieldId, ...] = ()

    def pin(self, fields: Iterable[FieldId]) -> None:
        """Record these fields also when they are not drawn any more, in place of those pinned before."""
        self._pinned = tuple(dict.fromkeys(fields))[:MAX_FIELDS]
        self._update_buffers()

    def suggest(self, fields: Iterable[FieldId]) -> None:
        """Record these fields until a screen draws some: the first one is opened after the drive that it shows."""
        suggested = tuple(dict.fromkeys(fields))[:MAX_FIELDS]
        if not self.was_asked and suggested != self._drawn:
            self._drawn = suggested
            self._update_buffers()

    @property
    def recorded(self) -> Mapping[FieldId, PointBuffer]:
        """The buffers to fill: those of pinned fields, and of what was drawn last, also while no screen draws it.

        Keys drive on another screen than the one that draws: what it showed before the drive is wanted after it.
        """
        return dict(self._buffers)

    def build_page(self, request: SeriesRequest, now: float, wall: float) -> SeriesPage:
        """Return what is new since `request.after`, oldest first; it is recorded from the first request on."""
        fields = tuple(dict.fromkeys(request.fields))[:MAX_FIELDS]
        self.was_asked = self.was_asked or bool(fields)
        if self.was_asked and fields != self._drawn:
            self._drawn = fields
            self._update_buffers()
        for buffer in self._buffers.values():
            buffer.flush(now)
        after = min(request.after, self._newest)
        if self._drawn and not self.was_asked:  # a screen that opens names no field yet and shall miss no point
            return SeriesPage(after, request.after, now, wall, (), ())
        state = self._last_of_page(after)
        points = [SeriesPoints(field, *self._buffers[field].take(after, state)) for field in fields]
        marks = self.marks.take(after, state)
        return SeriesPage(state, request.after, now, wall, tuple(each for each in points if each.times), marks)

    def _last_of_page(self, after: int) -> int:
        """Return the highest number up to which not more than PAGE points and marks follow `after`."""
        if self._size(after, self._newest) <= PAGE:
            return self._newest
        return bisect_right(range(self._newest), PAGE, lo=after, key=lambda limit: self._size(after, limit)) - 1

    def _size(self, after: int, limit: int) -> int:
        points = sum(self._buffers[field].new_points(after, limit) for field in self._drawn)
        return points + self.marks.new_marks(after, limit)

    def _update_buffers(self) -> None:
        """Forget the fields that are neither drawn nor pinned any more, and begin the new ones."""
        wanted = {*self._drawn, *self._pinned}
        kept = {field: buffer for field, buffer in self._buffers.items() if field in wanted}
        self._buffers = {field: kept.get(field) or PointBuffer(self._take_number) for field in wanted}
