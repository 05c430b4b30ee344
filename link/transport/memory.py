"""In-memory link with delay, jitter, loss and cuts: for tests in virtual time, and for faults on real links."""

from __future__ import annotations

import random
from collections import deque
from typing import Generic, TypeVar

Item = TypeVar("Item")


class LossyPipe(Generic[Item]):
    """One direction of a link. Frames stay in order: jitter delays those behind as well, as on a radio.

    `delay` and `jitter` in s (one way, jitter uniform in +-jitter), `loss` 0..1; `seed` makes the losses repeatable.
    """

    def __init__(self, *, delay: float = 0.0, jitter: float = 0.0, loss: float = 0.0, seed: int = 0) -> None:
        self.delay = delay
        self.jitter = jitter
        self.loss = loss
        self.cut = False
        """While True everything is lost, also frames under way."""
        self.lost = 0
        """Frames lost by chance or sent during a cut; those under way when it began are not counted."""
        self._random = random.Random(seed)
        self._under_way: deque[tuple[float, Item]] = deque()

    @property
    def next_arrival(self) -> float | None:
        """When the next frame arrives; None while none is under way."""
        return self._under_way[0][0] if self._under_way else None

    @property
    def waiting(self) -> int:
        """How many frames are under way."""
        return len(self._under_way)

    def send(self, data: Item, now: float) -> None:
        """Send `data`, or lose it."""
        if self.cut or self._random.random() < self.loss:
            self.lost += 1
            return
        arrival = now + max(0.0, self.delay + self._random.uniform(-self.jitter, self.jitter))
        if self._under_way:
            arrival = max(arrival, self._under_way[-1][0])
        self._under_way.append((arrival, data))

    def receive(self, now: float) -> list[Item]:
        """Return what has arrived by now."""
        if self.cut:
            self._under_way.clear()
        arrived: list[Item] = []
        while self._under_way and self._under_way[0][0] <= now:
            arrived.append(self._under_way.popleft()[1])
        return arrived
