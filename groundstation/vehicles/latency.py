"""Key to motor: from sending a changed demand to the vehicle's word (ROVER_DRIVE_STATUS) that the motors obey it."""

from __future__ import annotations

from collections import OrderedDict

MEMORY = 64
"""Demands remembered: a quarter of the sequence numbers, so that an old one is never taken for a new one."""

TOO_OLD = 2.0
"""s after which the word for a demand says nothing any more: the number may be that of another lap."""


class LatencyMeter:
    """Packet sequences of changed demands against the vehicle's answers. Steady demands are not answered at once."""

    def __init__(self) -> None:
        self.latest: float | None = None
        """s"""
        self._sent: OrderedDict[int, float] = OrderedDict()

    def record_sent(self, sequence: int, now: float) -> None:
        """A changed demand went out under this number."""
        self._sent.pop(sequence, None)
        self._sent[sequence] = now
        while len(self._sent) > MEMORY:
            self._sent.popitem(last=False)

    def record_applied(self, sequence: int, now: float, age: float) -> None:
        """The vehicle says that it obeys the demand with this number. Only the first word for it counts.

        `age` is that of the demand when the vehicle spoke, s: it may have waited for the next turn of its telemetry.
        """
        sent = self._sent.pop(sequence, None)
        if sent is not None and now - sent <= TOO_OLD:
            self.latest = max(0.0, now - sent - age)
