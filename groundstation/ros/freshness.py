"""LatenessCheck: finds messages that were held up on the way, without synchronised clocks. Time is an argument.

The clock of a publisher may be wrong by years, but it runs as fast as ours. So the smallest difference between arrival
and stamp that was seen lately is that of the fastest message, and what is more than MAX_LATENESS above it was held up:
after a router stood still for five seconds, the commands of those seconds arrive at once, and none may move a vehicle.
"""

from __future__ import annotations

import msgspec

MAX_LATENESS = 0.3
"""s more than the fastest message."""
MEMORY = 5.0
"""s after which a difference is forgotten: a clock that was set back makes all messages look late for as long."""
MAX_PUBLISHERS = 256


class _Publisher(msgspec.Struct):
    """The smallest difference of the current and of the last period, s."""

    began: float
    current: float
    last: float


class LatenessCheck(msgspec.Struct):
    """All publishers, by their ids."""

    _publishers: dict[bytes, _Publisher] = msgspec.field(default_factory=dict)

    def lateness(self, gid: bytes, stamp: int, now: float) -> float:
        """Return by how many s a message came later than the fastest. `stamp`: ns of its clock, `now`: s of ours."""
        difference = now - stamp / 1e9
        known = self._publishers.get(gid)
        if known is None:
            if len(self._publishers) >= MAX_PUBLISHERS:
                self._publishers.clear()
            self._publishers[gid] = _Publisher(now, difference, difference)
            return 0.0
        if now - known.began >= MEMORY:
            known.began, known.last, known.current = now, known.current, difference
        known.current = min(known.current, difference)
        return difference - min(known.current, known.last)
