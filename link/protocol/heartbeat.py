"""Liveness of a source: any accepted message counts.

Heartbeats alone gave false alarms on lossy links.
"""

from __future__ import annotations

import math


class HeartbeatMonitor:
    """Time since the last message of one source, s."""

    def __init__(self, timeout: float) -> None:
        self.timeout = timeout
        self._last_seen: float | None = None

    def update(self, now: float) -> None:
        """Record that a message of the source was accepted."""
        self._last_seen = now

    @property
    def ever_heard(self) -> bool:
        """Whether any message was accepted so far."""
        return self._last_seen is not None

    def silence(self, now: float) -> float:
        """Return the s since the last message; infinite when there was none."""
        return math.inf if self._last_seen is None else now - self._last_seen

    def is_alive(self, now: float) -> bool:
        """Return whether a message was accepted within the timeout."""
        return self.silence(now) <= self.timeout
