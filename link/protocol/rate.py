"""Token bucket, limit of each sender, and rate meter."""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable


class TokenBucket:
    """Allows `rate` per s on average, and bursts of `burst`."""

    def __init__(self, rate: float, burst: float) -> None:
        self._rate = rate
        self._burst = burst
        self._tokens = burst
        self._at: float | None = None

    def set_rate(self, rate: float, burst: float) -> None:
        """Change the rate; the tokens that are left stay, as far as they fit."""
        self._rate, self._burst = rate, burst
        self._tokens = min(burst, self._tokens)

    def consume(self, now: float, cost: float = 1.0) -> bool:
        """Take `cost` tokens and return True, or take none and return False."""
        tokens = self._tokens
        if self._at is not None:
            tokens += (now - self._at) * self._rate
            if tokens > self._burst:
                tokens = self._burst
        self._at = now
        enough = tokens >= cost
        self._tokens = tokens - cost if enough else tokens
        return enough


class SenderLimit:
    """Allows one event of each sender in `period` s. While `size` senders wait, there is none for others."""

    def __init__(self, period: float, size: int) -> None:
        self._period = period
        self._size = size
        self._at: dict[Hashable, float] = {}
        """Sender -> when it had its last one, oldest first."""

    def allow(self, sender: Hashable, now: float) -> bool:
        """Return whether a sender may have one now, and count it."""
        while self._at and now - next(iter(self._at.values())) >= self._period:
            del self._at[next(iter(self._at))]
        if sender in self._at or len(self._at) >= self._size:
            return False
        self._at[sender] = now
        return True


class RateMeter:
    """Events per s over the last `window` s."""

    def __init__(self, window: float = 1.0) -> None:
        self._window = window
        self._events: deque[tuple[float, float]] = deque()
        self._sum = 0.0

    def add(self, now: float, amount: float = 1.0) -> None:
        """Count `amount` events now."""
        self._events.append((now, amount))
        self._sum += amount
        self._forget(now)

    def rate(self, now: float) -> float:
        """Return the events per s."""
        self._forget(now)
        return self._sum / self._window

    def _forget(self, now: float) -> None:
        while self._events and self._events[0][0] <= now - self._window:
            self._sum -= self._events.popleft()[1]
