"""Arrivals: what threads of Zenoh have brought, until the event loop looks at it. Bounded, the oldest goes first.

The loop is woken for each frame that must not wait, and once for many frames of telemetry: to wake it costs more than
to handle a frame.
"""

from __future__ import annotations

from collections import deque
from enum import IntEnum

MAX_WAITING = 4096
"""Frames of all senders that may wait until the loop looks at them."""
TURN = 256
"""Frames that the loop looks at in one turn."""
PACE = 0.01
"""s for which telemetry may wait for more of it, once it comes faster than that."""

Arrival = tuple[str, bytes, float]
"""Key, frame, and when it came."""


class ArrivalState(IntEnum):
    """What the loop knows."""

    NOTHING = 0
    LATER = 1
    """It looks at most PACE from now."""
    NOW = 2


class Arrivals:
    """Frames with their keys. put() may be called from any thread, the rest from the loop."""

    def __init__(self) -> None:
        self.dropped = 0
        """Frames that were too many."""
        self._waiting: deque[Arrival] = deque()
        self._told = ArrivalState.NOTHING

    def put(self, key: str, data: bytes, now: float, *, may_wait: bool) -> bool:
        """Add a frame; return whether the loop must be told to take it."""
        self._waiting.append((key, data, now))
        if len(self._waiting) > MAX_WAITING:
            self._waiting.popleft()
            self.dropped += 1
        if self._told is ArrivalState.NOW or (may_wait and self._told is ArrivalState.LATER):
            return False
        self._told = ArrivalState.NOW
        return True

    def take(self) -> list[Arrival]:
        """Return the oldest frames, TURN at most. From now on the loop is told again."""
        self._told = ArrivalState.NOTHING  # before anything is taken: what comes after that tells the loop
        return [self._waiting.popleft() for _ in range(min(TURN, len(self._waiting)))]

    def expect(self, *, now: bool) -> None:
        """Note that the loop will look again by itself: `now` without delay, else within PACE."""
        self._told = ArrivalState.NOW if now else ArrivalState.LATER

    @property
    def is_empty(self) -> bool:
        """Whether nothing waits."""
        return not self._waiting
