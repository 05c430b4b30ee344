"""Speed of one vehicle and the demanded speed over the last minute."""

from __future__ import annotations

import math
from collections import deque

PERIOD = 0.5
"""s between two points: 120 in a minute, as many as a chart has columns."""

SPAN = 60.0
"""s."""


class SpeedSeries:
    """The points of the last SPAN seconds, oldest first."""

    def __init__(self) -> None:
        self._points: deque[tuple[float, float | None, float | None]] = deque()
        self._due = -math.inf

    def is_due(self, now: float) -> bool:
        """Return whether a point is due."""
        return now >= self._due

    def add(self, speed: float | None, demanded: float | None, now: float) -> None:
        """Add a point; None: not known."""
        self._due = now + PERIOD
        self._points.append((now, speed, demanded))
        while self._points[0][0] < now - SPAN:
            self._points.popleft()

    @property
    def points(self) -> tuple[tuple[float, float | None, float | None], ...]:
        """Time in s, speed, demanded speed."""
        return tuple(self._points)
