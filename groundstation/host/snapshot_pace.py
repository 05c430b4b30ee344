"""SnapshotPace: when the screens get a snapshot, as often as something may have changed. Time is an argument."""

from __future__ import annotations

import math

SNAPSHOT_PERIOD, REST_PERIOD = 0.1, 0.5
"""s between snapshots: as fast as a person can read, and the screen draws no faster; and while the station rests, when
only the readings of vehicles that stand change."""

LIVELY = 1.0
"""s after an intent of a screen, or a new line of the log, for which snapshots come at the fast rate."""


class SnapshotPace:
    """Decides every SNAPSHOT_PERIOD whether to send one."""

    def __init__(self) -> None:
        self._sent_at = self._lively_at = -math.inf
        self._log_state = 0

    def note(self, now: float) -> None:
        """Note that something was done, of which a screen waits to see the effect."""
        self._lively_at = now

    def is_due(self, now: float, *, rests: bool, log_state: int) -> bool:
        """Return whether to send a snapshot now; it then counts as sent.

        `rests`: nothing is armed or under way. `log_state`: a number that changes with each line of the log.
        """
        if log_state != self._log_state:
            self._log_state, self._lively_at = log_state, now
        rests = rests and now - self._lively_at > LIVELY
        if rests and now - self._sent_at < REST_PERIOD - SNAPSHOT_PERIOD / 2:  # the calls come a little early or late
            return False
        self._sent_at = now
        return True
