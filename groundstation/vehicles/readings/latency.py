"""Key-to-motor latency of a vehicle that reports which demand its motors obey (ROVER_DRIVE_STATUS).

From sending a changed demand until the first report that the motors obey it. Half of the way of both messages counts
for each direction.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import NamedTuple

from groundstation.vehicles.readings.key_to_motor import KeyTimings

MEMORY = 64
"""Demands remembered: a quarter of the sequence numbers, so that an old one is never taken for a new one."""

TOO_OLD = 2.0
"""s after which a report on a demand is ignored: its sequence number may have been used again."""


AGE_STEP = 0.001
"""s: resolution of `demand_age_ms`. A demand that is reported with the age 0 was obeyed within it."""


class SentDemand(NamedTuple):
    """A demand that was changed by a key, or by a timer."""

    made: float
    """When it was made, s."""
    sent: float
    key: float | None = None
    """s from the key press until it was sent; None: no key made it."""


class LatencyMeter:
    """Matches packet sequences of changed demands with the vehicle's reports; steady demands get none at once."""

    def __init__(self, timings: KeyTimings) -> None:
        self.latest: float | None = None
        """s"""
        self.reports = 0
        """Reports that gave a latency."""
        self._timings = timings
        self._sent: OrderedDict[int, SentDemand] = OrderedDict()

    def record_sent(self, sequence: int, demand: SentDemand) -> None:
        """Record that a changed demand was sent under this packet sequence number."""
        self._sent.pop(sequence, None)
        self._sent[sequence] = demand
        while len(self._sent) > MEMORY:
            self._sent.popitem(last=False)

    def record_applied(self, sequence: int, now: float, age: float) -> None:
        """Record that the vehicle obeys the demand with this sequence number. Only the first report counts.

        `age` is that of the demand when the report was sent, s: a report may wait for its turn in the telemetry.
        """
        demand = self._sent.pop(sequence, None)
        if demand is None or now - demand.made > TOO_OLD:
            return
        for copy in [number for number, other in self._sent.items() if other.made == demand.made]:
            del self._sent[copy]  # it arrives after the demand that is obeyed
        self.reports += 1
        self.latest = max(0.0, now - demand.made - age)
        self._timings.add(demand.key, max(0.0, now - demand.sent - age) / 2, age + AGE_STEP)
