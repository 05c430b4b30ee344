"""Upper bound of the key-to-motor latency of a vehicle that does not say which demand its motors obey.

From a changed demand until the first report with other outputs. Reports come at a few Hz, so that the motors were
sooner. A change counts only if the outputs stood still before it: else it may follow an earlier demand.
"""

from __future__ import annotations

from collections.abc import Sequence

from groundstation.vehicles.readings.key_to_motor import KeyTimings
from groundstation.vehicles.readings.latency import SentDemand

STEADY = 0.5
"""s for which the outputs must have been unchanged when the demand changes."""

TOO_OLD = 2.0
"""s until a demand that changes no output is forgotten: a dead band, another mode, another driver."""

NOISE = 0.01
"""Share of the value by which an output changes without a demand."""


class StepMeter:
    """Matches changed demands with changed outputs of one vehicle."""

    def __init__(self, timings: KeyTimings) -> None:
        self._timings = timings
        self._outputs: tuple[float, ...] | None = None
        self._changed_at = 0.0
        self._step: SentDemand | None = None

    def record_sent(self, demand: SentDemand) -> None:
        """Record that a changed demand was sent; the first one counts until an output changes."""
        if self._step is not None and demand.sent - self._step.sent <= TOO_OLD:
            return
        steady = self._outputs is not None and demand.sent - self._changed_at >= STEADY
        self._step = demand if steady else None

    def record_outputs(self, outputs: Sequence[float], round_trip: float | None, now: float) -> None:
        """Record the outputs that were reported; `round_trip` to the vehicle in s, None if not known."""
        before, self._outputs = self._outputs, tuple(outputs)
        if before is None or not _differ(before, self._outputs):
            self._outputs = before or self._outputs  # a slow drift must add up to a change
            self._changed_at = now if before is None else self._changed_at
            return
        step, self._step, self._changed_at = self._step, None, now
        if step is not None and now - step.sent <= TOO_OLD:
            heard = None if round_trip is None else min(now - step.sent, round_trip / 2)
            self._timings.add(step.key, heard, now - step.sent - (heard or 0.0))


def _differ(one: Sequence[float], other: Sequence[float]) -> bool:
    if len(one) != len(other):
        return True
    return any(abs(a - b) > NOISE * max(1.0, abs(a)) for a, b in zip(one, other, strict=True))
