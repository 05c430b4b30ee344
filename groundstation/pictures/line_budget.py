"""Pictures beside keys that drive: how large the next one may be, so that what a key changes is drawn soon after.

What is on the line to the terminal delays all that is drawn later, and the answers to pings: two that are missing lock
the keys. So one picture at most is on the line. It takes FRAME_TIME at most, by what the line has carried so far, and
then the line is free for a while. The first picture is small, because nothing is known of the line.
"""

from __future__ import annotations

from collections.abc import Callable

from groundstation.pictures.budget import MIN_RATE

FRAME_TIME = 0.12
"""s on the line that a picture may take."""
PATIENCE = 1.0
"""s after which the next picture goes out without an answer: some terminals answer none."""
DUTY = 1.5
"""Least time from one picture to the next, as a multiple of what the first one has taken."""
FIRST_ROOM, LEAST_ROOM = 12_000, 2_000
"""Bytes of the first picture, and of one on the slowest line."""
GROWTH = 4.0
"""By how much the estimate of the line grows at most with one picture."""
TELLING = 1500
"""Bytes of a picture from which on its time says something of the line."""
FINER_AFTER, FINER_ROOM = 0.5, 0.7
"""s after a change of the level until a finer one is tried, and the part of the room that it may need."""


class LineBudget:
    """When the next picture may go out, and how coarse it is. `limit`: bytes a second. Times are of one clock."""

    def __init__(self, limit: int) -> None:
        self.level = 0
        """0 is fine."""
        self._limit = limit
        self._rate = FIRST_ROOM / FRAME_TIME
        self._free_at = self._changed_at = 0.0
        self._sent_at: float | None = None
        """When the picture that is on the line went out."""
        self._size = 0
        self.answered = False
        """The terminal answers what stands behind a picture."""

    @property
    def room(self) -> float:
        """Bytes that the next picture may have."""
        most = self._limit / MIN_RATE
        return max(LEAST_ROOM, min(most, self._rate * FRAME_TIME)) if self.answered else min(most, FIRST_ROOM)

    def may_draw(self, now: float) -> bool:
        """Return whether a picture may go out."""
        if self._sent_at is not None and now - self._sent_at >= PATIENCE:
            self._sent_at = None
            self._rate /= GROWTH
        return now >= self._free_at and self._sent_at is None

    def choose_level(self, size_of: Callable[[int], int], coarsest: int, now: float) -> int:
        """Return the level of the picture that goes out now. `size_of`: level -> bytes of it."""
        level = min(self.level, coarsest)
        while level < coarsest and size_of(level) > self.room:
            level += 1
        if level == self.level and level and now - self._changed_at >= FINER_AFTER:
            while level and size_of(level - 1) <= FINER_ROOM * self.room:
                level -= 1
        if level != self.level:
            self.level, self._changed_at = level, now
        return level

    def note_frame(self, size: int, now: float) -> None:
        """Note that a picture of so many bytes goes out, with a ping behind it."""
        self._sent_at, self._size = now, size
        self._free_at = now + size / self._limit

    def note_read(self, took: float, round_trip: float) -> None:
        """Note that the terminal has read it, after so many s. `round_trip`: s of the quickest answer so far."""
        if self._sent_at is None:
            return
        self.answered = True
        self._free_at = max(self._free_at, self._sent_at + DUTY * took)
        self._sent_at = None
        if self._size >= TELLING:
            carried = self._size / max(took - round_trip, self._size / self._limit)
            self._rate = min(carried, GROWTH * self._rate)
