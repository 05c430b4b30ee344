"""How long to wait before the next try: soon at first, then ever less often."""

from __future__ import annotations

INITIAL_DELAY = 0.2
"""s: a cable that was only knocked is back before the driver has understood."""
MAX_DELAY = 5.0
"""s: a device that is plugged in again is found while one waits for it."""


class Backoff:
    """Of a connection 0.2, 0.4, 0.8, 1.6, 3.2, 5, 5 ... s."""

    def __init__(self, first: float = INITIAL_DELAY, longest: float = MAX_DELAY) -> None:
        self._first, self._longest = first, longest
        self._next = first

    def next_delay(self) -> float:
        """S until the next try."""
        wait, self._next = self._next, min(self._longest, self._next * 2)
        return wait

    def reset(self) -> None:
        """It works again."""
        self._next = self._first
