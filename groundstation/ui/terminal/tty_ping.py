"""Terminal pings: whether the line to the user works. Without input, output and clock."""

from __future__ import annotations

from collections import deque

PERIOD = 0.25
"""s between pings."""

REST_PERIOD = 1.0
"""s between pings while nothing can be driven."""

MISSES = 2
"""Unanswered pings until the terminal counts as silent: 0.5 s, as long as MAN_TIMEOUT of the vehicle."""

SILENT_AFTER = MISSES * PERIOD
"""s."""


class TerminalPing:
    """Pings of one terminal. One that never answered never counts as silent: it may not support the request."""

    def __init__(self) -> None:
        self._unanswered: deque[float] = deque(maxlen=8)
        self._sent: float | None = None
        self._waiting_since: float | None = None
        self._ever = False
        self.round_trip: float | None = None
        """Round trip of the newest answer, s."""
        self.quickest = 0.0
        """Round trip of the quickest one, s."""
        self._frame: float | None = None
        self._frame_took: float | None = None

    def next_due(self, now: float) -> bool:
        """Return whether a ping is due now; it then counts as sent."""
        if self._sent is not None and now - self._sent < PERIOD:
            return False
        self._sent = now
        if self.is_silent(now):
            self._unanswered.clear()  # answers that come after a silence cannot be told apart
        self._note_sent(now)
        return True

    def send_behind_frame(self, now: float) -> None:
        """Note a ping right behind a picture: its answer says that the terminal has read the picture."""
        self._frame, self._frame_took = now, None
        self._note_sent(now)

    def pop_frame_time(self) -> float | None:
        """Return once how many s the answer behind the newest picture took; None while there is none."""
        took, self._frame_took = self._frame_took, None
        return took

    def _note_sent(self, now: float) -> None:
        self._unanswered.append(now)
        if self._waiting_since is None:
            self._waiting_since = now

    def handle_answer(self, now: float) -> None:
        """Record an answer of the terminal."""
        first = not self._ever
        self._ever = True
        self._waiting_since = None
        if self._unanswered:
            sent = self._unanswered.popleft()
            self.round_trip = now - sent
            self.quickest = self.round_trip if first else min(self.quickest, self.round_trip)
            if sent == self._frame:
                self._frame, self._frame_took = None, self.round_trip

    def waited(self, now: float) -> float | None:
        """Return for how long an answer is missing, s; None for a terminal that never answered."""
        if not self._ever:
            return None
        return 0.0 if self._waiting_since is None else now - self._waiting_since

    def is_silent(self, now: float) -> bool:
        """Return whether a terminal that used to answer has missed too many pings."""
        waited = self.waited(now)
        return waited is not None and waited > SILENT_AFTER
