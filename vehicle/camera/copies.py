"""Copies of each packet, sent some time after it: a network rarely loses all of them. Time is an argument."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

from link.services.video_stream import COPY_PAYLOAD_TYPE, with_payload_type

COPY_DELAY = 0.01
"""s from one to the next: they share few disturbances, and all come while a receiver waits for a missing packet."""


class DelayedCopies:
    """Packets of which copies are due, so many of each."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._waiting: deque[tuple[float, int, bytes]] = deque()
        """When the next copy of a packet is due, and how many are."""

    @property
    def next_due(self) -> float | None:
        """When the next copy is due; None: there is none."""
        return self._waiting[0][0] if self._waiting else None

    def add(self, packet: bytes, now: float) -> None:
        """Keep a packet that was sent now."""
        if self._count:
            self._waiting.append((now + COPY_DELAY, self._count, with_payload_type(packet, COPY_PAYLOAD_TYPE)))

    def pop_due(self, now: float) -> Iterator[bytes]:
        """Yield the copies that are due."""
        while self._waiting and self._waiting[0][0] <= now:
            _, count, copy = self._waiting.popleft()
            if count > 1:
                self._waiting.append((now + COPY_DELAY, count - 1, copy))
            yield copy
