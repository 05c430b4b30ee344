"""The clock of signatures: follows the computer's clock forward, never goes back, and survives a boot in 1970.

Rules: https://mavlink.io/en/guide/message_signing.html#timestamp. It begins with the computer's clock. If that is
behind the time stored by the last run, or not set at all, it begins BOOT_LEAD after the stored time, as in ArduPilot.
It takes over no timestamp of a peer: the time of each key is followed for that key alone (verifier.py).
"""

from __future__ import annotations

TICKS = 100_000
"""Timestamps a second."""
EPOCH = 1_420_070_400
"""2015-01-01 in Unix time, s: timestamp 0."""
BOOT_LEAD = 60 * TICKS
"""Added to the stored time if the computer's clock is behind it: more than passes between two stores."""
PLAUSIBLE = (1_767_225_600 - EPOCH) * TICKS
"""2026-01-01: before it, a computer's clock has not been set."""
DAY = 86_400 * TICKS
FOLLOWED_MAX = (4_102_444_800 - EPOCH) * TICKS
"""2100-01-01: later timestamps are not followed, because none could follow the last one of 2104."""


def to_stamp(wall: float) -> int:
    """Return the timestamp of a Unix time; 0 before 2015."""
    return max(0, int((wall - EPOCH) * TICKS))


class SigningClock:
    """Gives timestamps of 10 us. `now` is s of a monotonic clock, `wall` Unix time in s."""

    __slots__ = ("_offset", "_wall_offset", "synchronized", "trusted")

    def __init__(self, wall: float, now: float, stored: int = 0, *, synchronized: bool = False) -> None:
        """Begin. `stored`: the `stamp` of the last run; 0 if there was none. `synchronized`: see update()."""
        computer = to_stamp(wall)
        self.trusted = computer >= max(stored, PLAUSIBLE)
        """The computer's clock is set, and not behind what was known before."""
        start = computer if self.trusted else max(computer, stored + BOOT_LEAD if stored else 0)
        self._offset = start - now * TICKS
        self._wall_offset = computer - now * TICKS
        self.synchronized = synchronized and self.trusted
        """This is the right time: the operating system says so, and it is not behind what was known before."""

    def update(self, wall: float, now: float, *, synchronized: bool = False) -> None:
        """Follow the computer's clock forward; it may have been set. Call it once a second.

        `synchronized`: the operating system keeps that clock right by a source of time. A computer without a battery
        for its clock begins with the time of its last shutdown, which looks like a clock that is set.
        """
        computer = to_stamp(wall)
        self._wall_offset = computer - now * TICKS
        if self._wall_offset >= self._offset:
            self._offset = self._wall_offset
            self.trusted = self.trusted or computer >= PLAUSIBLE
        self.synchronized = synchronized and self.trusted and self._wall_offset >= self._offset

    def stamp(self, now: float) -> int:
        """Return the time, as a timestamp."""
        return int(now * TICKS + self._offset)

    def ahead(self, now: float) -> float:
        """Return the s by which this clock is ahead of the computer's."""
        return max(0.0, (self.stamp(now) - now * TICKS - self._wall_offset) / TICKS)
