"""How often work is done that finds nothing to do in most control cycles. Time is an argument."""

from __future__ import annotations

from dialects.messages import Heartbeat, ManualControl, Ping, RoverOperatorPresence, Timesync

PERIOD = 0.1
"""s between two times while nothing is under way: every fifth control cycle."""
REST_PERIOD = 0.2
"""s between two control cycles of a disarmed rover with nothing under way: the interval of its fastest stream."""
BUSY_TIME = 2.0
"""s in each cycle after the last event: longer than what is under way is silent."""
EARLY = 0.005
"""s; work is due this much early, or rounding would delay it by a cycle."""
ROUTINE = (Heartbeat, ManualControl, RoverOperatorPresence, Timesync, Ping)
"""Messages that come all the time and leave nothing under way, but for a demand of an armed rover."""


class Activity:
    """Whether something is under way: a transfer, a command, a change of state."""

    def __init__(self, now: float) -> None:
        self._until = now + BUSY_TIME

    def resume_full_rate(self, now: float) -> None:
        """Note that something has happened that may take several cycles."""
        self._until = now + BUSY_TIME

    def is_busy(self, now: float) -> bool:
        """Return whether something has happened in the last BUSY_TIME."""
        return now <= self._until


class Pace:
    """Work that is due in each cycle while something is under way, and else every PERIOD."""

    def __init__(self, activity: Activity) -> None:
        self._activity = activity
        self._due = 0.0

    def is_due(self, now: float) -> bool:
        """Return whether the work is due in this cycle."""
        return now >= self._due or self._activity.is_busy(now)

    def mark_done(self, now: float) -> None:
        """Note that the work was done."""
        self._due = now + PERIOD - EARLY
