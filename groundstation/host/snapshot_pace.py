"""SnapshotPace: when the screens get a snapshot, as often as something may have changed. Time is an argument."""

from __future__ import annotations

import math
from collections.abc import Hashable

from groundstation.intents import session

SLOT = 0.1
"""s between two calls: within that a screen shows who drives, what is armed, what stops, and the keys that count."""

STEADY_PERIOD, REST_PERIOD = 0.2, 0.5
"""s between snapshots that only have other readings: faster than a person reads figures; and while the station rests,
when only the readings of vehicles that stand change."""

CALLS_AT_REST = session.REST_PERIOD
"""s between two calls at rest. What ends the rest brings the next one SLOT after the last, or at once."""

LIVELY = 1.0
"""s after an intent of a screen, or a new line of the log, for which a station that rests sends as many as before."""


class SnapshotPace:
    """Decides every SLOT, and at rest every CALLS_AT_REST, whether to send one."""

    def __init__(self) -> None:
        self._sent_at = self._lively_at = -math.inf
        self._urgent_state: Hashable = None

    def note(self, now: float) -> None:
        """Note that something was done, of which a screen waits to see the effect."""
        self._lively_at = now

    def call_period(self, now: float, *, rests: bool) -> float:
        """Return the s until the next call of `is_due`; `rests` as there."""
        return CALLS_AT_REST if self._rests(now, rests=rests) else SLOT

    def is_due(self, now: float, *, rests: bool, urgent_state: Hashable) -> bool:
        """Return whether to send a snapshot now; it then counts as sent.

        `rests`: nothing is armed or under way. `urgent_state`: what a driver must see in the next SLOT if it changes.
        """
        if urgent_state != self._urgent_state:
            self._urgent_state, self._lively_at = urgent_state, now
        elif now - self._sent_at < self._period(now, rests=rests) - SLOT / 2:  # the calls come a little early or late
            return False
        self._sent_at = now
        return True

    def _period(self, now: float, *, rests: bool) -> float:
        return REST_PERIOD if self._rests(now, rests=rests) else STEADY_PERIOD

    def _rests(self, now: float, *, rests: bool) -> bool:
        return rests and now - self._lively_at > LIVELY
