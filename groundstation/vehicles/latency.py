"""Key-to-motor latency: from sending a changed demand until ROVER_DRIVE_STATUS reports that the motors obey it."""

from __future__ import annotations

from collections import OrderedDict

MEMORY = 64
"""Demands remembered: a quarter of the sequence numbers, so that an old one is never taken for a new one."""

TOO_OLD = 2.0
"""s after which a report on a demand is ignored: its sequence number may have been used again."""


class LatencyMeter:
    """Matches packet sequences of changed demands with the vehicle's reports; steady demands get none at once."""

    def __init__(self) -> None:
        self.latest: float | None = None
        """s"""
        self.reports = 0
        """Reports that gave a latency."""
        self._sent: OrderedDict[int, float] = OrderedDict()

    def record_sent(self, sequence: int, now: float) -> None:
        """Record that a changed demand was sent under this packet sequence number."""
        self._sent.pop(sequence, None)
        self._sent[sequence] = now
        while len(self._sent) > MEMORY:
            self._sent.popitem(last=False)

    def record_applied(self, sequence: int, now: float, age: float) -> None:
        """Record that the vehicle obeys the demand with this sequence number. Only the first report counts.

        `age` is that of the demand when the report was sent, s: a report may wait for its turn in the telemetry.
        """
        sent = self._sent.pop(sequence, None)
        if sent is not None and now - sent <= TOO_OLD:
            self.reports += 1
            self.latest = max(0.0, now - sent - age)
