"""Time in a log: s since its first record, which never go back, and the wall clock that was recorded.

The clock of a small computer jumps when it learns the time, and damage can hit a stamp. So the log is cut into segments
where the recorded clock goes back or leaps forward; the time in the log goes on evenly from one to the next.
"""

from __future__ import annotations

from array import array
from bisect import bisect_right

from link.tlog.tlog import LATEST

LEAP = 3600.0
"""s between two samples from which on the clock was set, or the recording paused: replay does not wait that long."""

BACK = 1.0
"""s that stamps may go back: two links are recorded with clocks of their own, and packets overtake each other."""

CONFIRMED = 30.0
"""s within which the next record must follow, so that a stamp counts as right."""

MAX_SEGMENTS = 1000


class LogClock:
    """Segments of the recorded clock. Samples are added in the order of the file."""

    def __init__(self) -> None:
        self._offsets = array("Q")
        self._elapsed = array("d")
        self._stamps = array("q")
        self.now = 0.0
        """s from the first record to the newest sample."""
        self._stamp = 0

    @property
    def started(self) -> bool:
        """A sample was added."""
        return bool(self._offsets)

    @property
    def jumps(self) -> int:
        """How often the recorded clock jumped."""
        return max(0, len(self._offsets) - 1)

    def add(self, offset: int, stamp: int, following: int | None) -> bool | None:
        """Add the stamp of a record and that of the next one, us. Return whether the clock jumped there.

        A stamp that the next record does not confirm is left out: damage may have hit it. It returns None then.
        """
        if stamp > LATEST or (following is not None and not 0 <= (following - stamp) / 1e6 + BACK <= CONFIRMED):
            return None
        passed = (stamp - self._stamp) / 1e6
        if 0 <= passed <= LEAP and self._offsets:  # nearly always
            self._stamp, self.now = stamp, max(self.now, self._elapsed[-1] + (stamp - self._stamps[-1]) / 1e6)
            return False
        jumped = not self.started or not -BACK <= passed <= LEAP
        if jumped and len(self._offsets) < MAX_SEGMENTS:
            self._begin(offset, stamp)
            return len(self._offsets) > 1
        self.now = max(self.now, self.elapsed(offset, stamp))
        self._stamp = max(self._stamp, stamp)
        return False

    def _begin(self, offset: int, stamp: int) -> None:
        self._offsets.append(offset)
        self._elapsed.append(self.now)
        self._stamps.append(stamp)
        self._stamp = stamp

    def elapsed(self, offset: int, stamp: int) -> float:
        """Return the time of a record, s since the first one; within its segment whatever its stamp is."""
        if not self._offsets:
            return 0.0
        if offset >= self._offsets[-1]:  # while the index grows
            passed = (stamp - self._stamps[-1]) / 1e6
            return self._elapsed[-1] + passed if passed > 0 else self._elapsed[-1]
        at = max(0, bisect_right(self._offsets, offset) - 1)
        end = self._elapsed[at + 1] if at + 1 < len(self._elapsed) else float("inf")
        return min(end, max(self._elapsed[at], self._elapsed[at] + (stamp - self._stamps[at]) / 1e6))

    def wall(self, elapsed: float) -> float:
        """Return the recorded wall clock at a time of the log, s since 1970."""
        if not self._offsets:
            return 0.0
        at = max(0, bisect_right(self._elapsed, elapsed) - 1)
        return self._stamps[at] / 1e6 + elapsed - self._elapsed[at]

    def find_wall(self, wall: float) -> float:
        """Return the time of the log at which the recorded clock showed `wall`; the nearest one if it never did."""
        best, least = 0.0, float("inf")
        for at, start in enumerate(self._elapsed):
            end = self._elapsed[at + 1] if at + 1 < len(self._elapsed) else self.now
            time = min(max(start, start + wall - self._stamps[at] / 1e6), end)
            if (distance := abs(self.wall(time) - wall)) < least:
                best, least = time, distance
        return best
