"""Copies of a changed demand: when they follow it, by the loss of the link, and how much of the link they may take.

The next regular demand comes 50 ms later, which is how long the loss of a change would last. Copies a few ms apart
survive a short disturbance, which takes copies that are sent together. Without a clock.
"""

from __future__ import annotations

from collections import deque

PLANS: tuple[tuple[float, tuple[float, ...]], ...] = (
    (0.10, (0.002, 0.004, 0.007, 0.011, 0.016)),
    (0.03, (0.002, 0.005, 0.009)),
    (0.0, (0.003,)),
)  # fmt: skip
"""Loss from which a row holds, 0..1 -> s from the change to each copy. At 10 % loss all of the row are lost once in
10^6, at 30 % once in 1400, if losses are independent."""

SHARE = 0.15
"""Part of a link's capacity that copies may take within any PERIOD."""

DEMAND_BYTES = 82
"""Of the longest demand, a signed ROVER_OPERATOR_PRESENCE."""

MOST = 100
"""Copies within any PERIOD where the capacity is not known. The vehicle takes 200 demands/s (link/protocol/peer.py)."""

PERIOD = 1.0
"""s."""


class DemandCopies:
    """Plans the copies for one vehicle. A newer change replaces what is planned."""

    def __init__(self) -> None:
        self._plan = PLANS[-1][1]
        self._most = MOST
        self._planned: deque[float] = deque()
        self._sent: deque[float] = deque()
        """When the copies of the last PERIOD were sent."""

    def adapt(self, loss: float | None, capacity: float | None) -> None:
        """Set what is known of the link: lost fraction of its frames, and bytes/s; None: not known."""
        self._plan = next(plan for least, plan in PLANS if (loss or 0.0) >= least)
        self._most = MOST if capacity is None else min(MOST, int(SHARE * capacity * PERIOD / DEMAND_BYTES))

    def plan(self, now: float) -> None:
        """Plan the copies of a demand that has changed now."""
        self._planned = deque(now + after for after in self._plan)

    @property
    def due_at(self) -> float | None:
        """When the next copy is due; None: there is none."""
        return self._planned[0] if self._planned else None

    def take(self, now: float, *, neutral: bool) -> bool:
        """Return whether to send a copy now. Half of what the link has room for is kept for `neutral` ones."""
        if not self._planned or now < self._planned[0]:
            return False
        while self._planned and self._planned[0] <= now:  # after a pause one copy is enough
            self._planned.popleft()
        while self._sent and now - self._sent[0] >= PERIOD:
            self._sent.popleft()
        if len(self._sent) >= (self._most if neutral else (self._most + 1) // 2):
            return False
        self._sent.append(now)
        return True
