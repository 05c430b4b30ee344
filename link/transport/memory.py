"""A pipe in memory that delays, drops and cuts: two cores joined by a pair of them need no network and no clock."""

from __future__ import annotations

import random
from collections import deque


class LossyPipe:
    """One direction of a link. Nothing overtakes: jitter delays what is behind it, as a radio does.

    `delay` and `jitter` in s (one way, jitter uniform in +-jitter), `loss` 0..1, `seed` makes it repeatable.
    """

    def __init__(self, *, delay: float = 0.0, jitter: float = 0.0, loss: float = 0.0, seed: int = 0) -> None:
        self.delay = delay
        self.jitter = jitter
        self.loss = loss
        self.cut = False
        """While true all is lost, also what is under way."""
        self.lost = 0
        """How many were lost by chance or by a cut, those under way not counted."""
        self._random = random.Random(seed)
        self._under_way: deque[tuple[float, bytes]] = deque()

    def send(self, data: bytes, now: float) -> None:
        """Put `data` on its way, or lose it."""
        if self.cut or self._random.random() < self.loss:
            self.lost += 1
            return
        arrival = now + max(0.0, self.delay + self._random.uniform(-self.jitter, self.jitter))
        if self._under_way:
            arrival = max(arrival, self._under_way[-1][0])
        self._under_way.append((arrival, data))

    def receive(self, now: float) -> list[bytes]:
        """What has arrived by now."""
        if self.cut:
            self._under_way.clear()
        arrived: list[bytes] = []
        while self._under_way and self._under_way[0][0] <= now:
            arrived.append(self._under_way.popleft()[1])
        return arrived
