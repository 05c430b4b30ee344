"""Is the line to the person alive? Pings of the terminal, counted. No input, no output, no clock."""

from __future__ import annotations

from collections import deque

PERIOD = 0.25
"""s between pings."""

MISSES = 2
"""Pings unanswered until the terminal counts as silent: 0.5 s, the same as a lost link to the vehicle (MAN_TIMEOUT)."""


class TerminalPing:
    """One terminal. A terminal that never answered is never called silent: it may not know the question."""

    def __init__(self) -> None:
        self._unanswered: deque[float] = deque(maxlen=8)
        self._sent: float | None = None
        self._waiting_since: float | None = None
        self._ever = False
        self.round_trip: float | None = None
        """s, of the newest answer."""

    def next_due(self, now: float) -> bool:
        """True when a ping is to be sent now; it then counts as sent."""
        if self._sent is not None and now - self._sent < PERIOD:
            return False
        self._sent = now
        if self.is_silent(now):
            self._unanswered.clear()  # answers that come after a silence cannot be told apart
        self._unanswered.append(now)
        if self._waiting_since is None:
            self._waiting_since = now
        return True

    def handle_answer(self, now: float) -> None:
        """The terminal answered."""
        self._ever = True
        self._waiting_since = None
        if self._unanswered:
            self.round_trip = now - self._unanswered.popleft()

    def is_silent(self, now: float) -> bool:
        """It used to answer and now has missed too many."""
        waited = 0.0 if self._waiting_since is None else now - self._waiting_since
        return self._ever and waited > MISSES * PERIOD
