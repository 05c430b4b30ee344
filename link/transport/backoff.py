"""Delays between attempts to reconnect: short at first, then doubled up to a maximum."""

from __future__ import annotations

INITIAL_DELAY = 0.2
"""s: a loose cable is reconnected before the operator notices."""
MAX_DELAY = 5.0
"""s: a device that is plugged in again is found while the user waits for it."""


class Backoff:
    """The delays of one connection: 0.2, 0.4, 0.8, 1.6, 3.2, 5, 5 ... s."""

    def __init__(self, first: float = INITIAL_DELAY, longest: float = MAX_DELAY) -> None:
        self._first, self._longest = first, longest
        self._next = first

    def next_delay(self) -> float:
        """Return the delay before the next attempt, s, and double the one after."""
        delay, self._next = self._next, min(self._longest, self._next * 2)
        return delay

    def reset(self) -> None:
        """Start again with the first delay, after a success."""
        self._next = self._first
