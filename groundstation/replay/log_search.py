"""LogSearch: looks for the next place in a log that a query means, interval by interval."""

from __future__ import annotations

from collections.abc import Iterator

from dialects.codec import CRC_EXTRA, decode_frame
from dialects.messages import Heartbeat
from groundstation.replay.log_index import LogIndex
from groundstation.replay.query import Query
from groundstation.vehicles.state.vehicle_heartbeat import is_vehicle
from link.tlog.scan import LogFrame, id_of


class LogSearch:
    """Searches from a position to the end and on from the start. A condition is found where it begins to hold."""

    def __init__(self, index: LogIndex, query: Query, time: float, offset: int) -> None:
        """`offset`: behind the last record that was shown, at `time`."""
        self.query = query
        self.found: tuple[float, int] | None = None
        """Time and offset of the record that was found."""
        self.wrapped = False
        """It was found before the position."""
        self._index = index
        self._time, self._offset = time, offset
        self.done = False
        if query.message_id is None:
            self._search_events()
            return
        self._having = self._find_intervals()
        self._numbers = self._order()
        self._held = self._held_before()

    def _search_events(self) -> None:
        events = self._index.findings.finder.events
        first = events.place(self._time, after=True)
        for at in (*range(first, len(events)), *range(first)):
            event = events[at]
            if self.query.text.lower() in f"{event.kind} {event.text}".lower():
                self.found, self.wrapped = (event.time, event.offset), at < first
                break
        self.done = True

    def _order(self) -> Iterator[tuple[int, bool]]:
        """Yield the intervals that have the message, and whether they come again from the start."""
        first = self._index.interval_of(self._offset)
        yield from ((number, False) for number in self._having if number >= first)
        yield from ((number, True) for number in self._having if number <= first)

    def _held_before(self) -> bool:
        """Return whether the condition holds at the position, by the newest message before it."""
        first = self._index.interval_of(self._offset)
        for number in reversed([each for each in self._having if each <= first]):
            frames = [each for each in self._index.read_interval(number).frames if each.at < self._offset]
            held = [self._holds(frame) for frame in frames]
            known = [each for each in held if each is not None]
            if known:
                return known[-1]
        return False

    def _find_intervals(self) -> list[int]:
        """Return the numbers of the intervals that have a message of the id."""
        places = (offsets for key, offsets in self._index.places.items() if id_of(key) == self.query.message_id)
        return sorted({self._index.interval_of(offset) for offsets in places for offset in offsets})

    def advance(self) -> bool:
        """Search one more interval. Returns whether there is more to do."""
        if self.done:
            return False
        number, again = next(self._numbers, (None, True))
        if number is None:
            self.done = True
            return False
        if again and not self.wrapped:
            self.wrapped, self._held = True, False
        for time, frame in self._index.timed_frames(number):
            if (frame.at >= self._offset or again) and self._matches(frame):
                self.found, self.done = (time, frame.at), True
                break
        return not self.done

    def _matches(self, frame: LogFrame) -> bool:
        """Return whether the condition begins to hold with this frame; any message where there is no condition."""
        holds = self._holds(frame)
        if holds is None:
            return False
        before, self._held = self._held, holds and self.query.holds is not None
        return holds and not before

    def _holds(self, frame: LogFrame) -> bool | None:
        """Return whether the condition holds in this frame; None for one that it does not concern."""
        if frame.message_id != self.query.message_id or frame.message_id not in CRC_EXTRA:
            return None
        if self.query.holds is None:
            return True
        message = decode_frame(frame.message_id, frame.raw)
        if isinstance(message, Heartbeat) and not is_vehicle(message):
            return None
        return self.query.holds(message)
