"""Detects that the station process stood still for so long that the watchdog may have sent neutral in its place.

The station reports to the watchdog (groundstation/watchdog/) that it runs. Both measure the same silence on the same
clock, and the station from the earlier moment: if the watchdog has acted, the station finds out before it sends.
"""

from __future__ import annotations

STALL_TIMEOUT = 0.3
"""s without a report of the station after which the watchdog sends neutral: three reports. As long as the lease of the
screen, so that a busy machine causes no more stops than before."""


REST_STALL_TIMEOUT = 1.0
"""The same after a report that nothing is armed or under way: there is no vehicle to send neutral to."""


class StallMonitor:
    """Time since the last report to the watchdog. Without any report, as without a watchdog, nothing is a stall."""

    def __init__(self) -> None:
        self._reported_at: float | None = None
        self._timeout = STALL_TIMEOUT

    def record_report(self, now: float, *, rests: bool = False) -> None:
        """Record that a report was sent. `rests`: it says so, and the next one may follow later."""
        self._reported_at = now
        self._timeout = REST_STALL_TIMEOUT if rests else STALL_TIMEOUT

    def is_stalled(self, now: float) -> bool:
        """Return whether the last report is older than STALL_TIMEOUT, or REST_STALL_TIMEOUT if it allowed that."""
        return self._reported_at is not None and now - self._reported_at > self._timeout

    def pop_stall(self, now: float) -> float | None:
        """Return for how many s the process stood still, once each time; else None."""
        if self._reported_at is None or not self.is_stalled(now):
            return None
        stalled_for, self._reported_at = now - self._reported_at, now
        return stalled_for


class Standstill:
    """Remembers that the process stood still, so that what a verb demanded before has ended, until `forget`."""

    def __init__(self) -> None:
        self._monitor = StallMonitor()
        self._stall: float | None = None

    def record_report(self, now: float) -> None:
        """Record that the process runs."""
        self.last(now)
        self._monitor.record_report(now)

    def last(self, now: float) -> float | None:
        """Return for how many s the process stood still; None: it did not, or nothing is reported."""
        self._stall = self._stall or self._monitor.pop_stall(now)
        return self._stall

    def forget(self) -> None:
        """Allow demands again: what was demanded before is withdrawn."""
        self._stall = None
