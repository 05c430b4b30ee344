"""Second pass over a log, behind the index: checks each checksum, and counts the packet numbers that are missing."""

from __future__ import annotations

from groundstation.replay.log_index import LogIndex
from link.tlog.scan import LogFrame

MOST_LOST = 128
"""A larger step of the packet numbers is a restart or an older packet, and no loss."""

MAX_SOURCES = 1000


class LogCheck:
    """Works through the intervals of an index."""

    def __init__(self, index: LogIndex) -> None:
        self._index = index
        self._next = 0
        self._sequences: dict[tuple[int, int], int] = {}
        self.lost = 0
        """Packet numbers that are missing."""
        self.damaged = 0
        """Bytes with a wrong checksum, beside those that the index has found."""

    @property
    def complete(self) -> bool:
        """All intervals that are indexed are checked."""
        return self._next >= len(self._index.starts)

    @property
    def progress(self) -> float:
        """How much of the index is checked, 0..1."""
        count = len(self._index.starts)
        return self._next / count if count else 1.0

    def advance(self) -> bool:
        """Check one more interval. Returns whether there is more to do."""
        if self.complete:
            return False
        number, self._next = self._next, self._next + 1
        result = self._index.read_interval(number)
        self._count_lost(result.frames, self._index.times[number])
        if not self._index.careful[number]:
            for damage in result.damage:
                self.damaged += damage.size
                before = self._index.time_before(result, damage.offset)
                self._index.findings.add_damage(before, damage.offset, damage.size)
        return not self.complete

    def _count_lost(self, frames: list[LogFrame], time: float) -> None:
        """Count the missing numbers of an interval that begins at a time."""
        sequences = self._sequences
        for frame in frames:
            _, _, _, system, component, sequence, _ = frame
            before = sequences.get((system, component))
            if before is not None:
                lost = (sequence - before - 1) & 0xFF
                if 0 < lost < MOST_LOST:
                    self.lost += lost
                    at = max(time, self._index.clock.elapsed(frame.at, frame.stamp))
                    self._index.findings.lost.add(min(at, self._index.duration), lost)
            elif len(sequences) >= MAX_SOURCES:
                continue
            sequences[system, component] = sequence
