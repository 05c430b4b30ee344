"""Is the other end alive? Any accepted message counts as life: heartbeats alone gave false alarms on lossy links."""

from __future__ import annotations

import math


class HeartbeatMonitor:
    """Silence of one source, in s."""

    def __init__(self, timeout: float) -> None:
        self.timeout = timeout
        self._heard: float | None = None

    def update(self, now: float) -> None:
        """Something of the source was accepted."""
        self._heard = now

    @property
    def ever_heard(self) -> bool:
        """Was it ever heard?"""
        return self._heard is not None

    def silence(self, now: float) -> float:
        """Seconds since it was heard; infinite when it never was."""
        return math.inf if self._heard is None else now - self._heard

    def is_alive(self, now: float) -> bool:
        """Was it heard within the timeout?"""
        return self.silence(now) <= self.timeout
