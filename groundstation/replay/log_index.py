"""Index of a telemetry log: where each moment is, what happened, and what is needed to rebuild the state there.

It grows interval by interval: the caller decides how long it may work at a time. A file that grows is followed. Memory
is bounded: a few MB for 1 GB of log.
"""

from __future__ import annotations

from array import array
from bisect import bisect_left, bisect_right
from collections.abc import Iterator

from groundstation.replay.findings import Findings, KnownBeat
from groundstation.replay.log_clock import LogClock
from groundstation.replay.source import LogSource
from link.tlog.scan import (
    BEYOND,
    STAMP,
    CarefulScan,
    FastScan,
    LogFrame,
    SourceKey,
    frame_at,
    id_of,
    key_of,
    plain_frame_at,
    scan,
    scan_fast,
    stamp_at,
)

INTERVAL = 64 * 1024
"""Bytes between two places where reading may begin: some 1400 messages, which a station reads in 50 ms."""

MAX_KEYS = 4000
"""Kinds of messages by source: a flood of invented ids must not grow the index."""


class LogIndex:
    """Intervals, kinds of messages with their places, times, findings."""

    def __init__(self, source: LogSource) -> None:
        self._source = source
        self.clock = LogClock()
        self.findings = Findings()
        self.starts = array("Q")
        self.times = array("d")
        """Time at which an interval starts, s since the first record."""
        self._sure = bytearray()
        """For each interval, whether a valid record ends where it starts."""
        self.careful = bytearray()
        """For each interval, whether all its checksums were checked while it was indexed."""
        self.places: dict[SourceKey, array[int]] = {}
        """Key -> offset of its last record in each interval that has one."""
        self.frames = 0
        self.damaged = 0
        """Bytes of damage that broke the chain of records."""
        self.end = 0
        """Offset up to which the file is indexed."""
        self.tail = 0
        """Bytes behind `end` that are not a whole record."""
        self._end_sure = True
        self._wanted: set[SourceKey] = set()
        self._known: set[SourceKey] = set()

    # ---- growing ----

    @property
    def complete(self) -> bool:
        """All of the file is indexed, as long as it is now."""
        return self.end + self.tail >= self._source.size

    @property
    def progress(self) -> float:
        """How much of the file is indexed, 0..1."""
        return min(1.0, (self.end + self.tail) / max(1, self._source.size))

    @property
    def duration(self) -> float:
        """Time from the first record to the last one that is indexed, s."""
        return self.clock.now

    def advance(self) -> bool:
        """Index one more interval. Returns whether there is more to do."""
        if self.complete:
            return False
        start = self.end
        block, limit, final = self._read(start)
        fast = self._scan_fast(block, start, limit) if self._end_sure else None
        if fast is not None:
            self._add_interval(start, careful=False)
            self._add_fast(fast, block, start)
            self.end, self.tail, self._end_sure = fast.end, 0, True
        else:
            self._add_careful(scan(block, start, limit, final=final, sure=self._end_sure), start)
        return not self.complete

    def _read(self, start: int) -> tuple[bytes, int, bool]:
        size = self._source.size
        limit = min(start + INTERVAL, size)
        return self._source.read(start, limit - start + BEYOND), limit, limit + BEYOND >= size

    def _scan_fast(self, block: bytes, start: int, limit: int) -> FastScan | None:
        result = scan_fast(block, start, limit, self._wanted)
        if result is None:
            return None
        fresh = result.last.keys() - self._known
        if fresh and self._learn(fresh):
            result = scan_fast(block, start, limit, self._wanted)
        return result

    def _learn(self, keys: set[SourceKey]) -> bool:
        """Note new kinds of messages; return whether one of them holds findings."""
        room = MAX_KEYS - len(self._known)
        new = set(list(keys)[:room])
        wanted = {key for key in new if self.findings.wants(id_of(key))}
        self._known |= new
        self._wanted |= wanted
        return bool(wanted)

    def _add_interval(self, start: int, *, careful: bool) -> None:
        self.starts.append(start)
        self.times.append(self.clock.now)
        self._sure.append(self._end_sure)
        self.careful.append(careful)

    def _add_fast(self, fast: FastScan, block: bytes, base: int) -> None:
        self.frames += fast.count
        self._keep_places(fast.last)
        beats, places = self.findings.beats, {base, *fast.found, max(fast.last.values())}
        for at in sorted(places):
            start = at - base
            beat = beats.get(block[start + 13 : start + 18])
            if beat is not None and block.startswith(beat.head, start + STAMP) and beat.is_in(block, start):
                self._add_repeated(beat, at, block, start)
                continue
            frame = plain_frame_at(block, start, base)
            if frame is None:
                frame = frame_at(block, start, base, trust_unknown=True, final=True)
            if frame is not None:
                self._add_frame(frame, stamp_at(block, frame.end - base))

    def _add_repeated(self, beat: KnownBeat, at: int, block: bytes, start: int) -> None:
        """Add a HEARTBEAT whose payload is that of the one before, which was checked: its time is all that is new."""
        stamp, following = stamp_at(block, start), stamp_at(block, start + beat.size)
        assert stamp is not None  # the scan has found the record
        time = self._time(at, stamp, following)
        if not self.findings.repeat_beat(beat, time):
            frame = plain_frame_at(block, start, at - start)
            if frame is not None:
                self.findings.add(time, frame)

    def _add_careful(self, result: CarefulScan, start: int) -> None:
        if result.frames or result.damage:
            self._add_interval(start, careful=True)
        last: dict[SourceKey, int] = {}
        for frame, following in with_following(result.frames):
            key = key_of(frame)
            last[key] = frame.at
            if key not in self._known:
                self._learn({key})
            if key in self._wanted or following is None:
                self._add_frame(frame, following)
        self.frames += len(result.frames)
        self._keep_places(last)
        for damage in result.damage:
            self.damaged += damage.size
            self.findings.add_damage(self.time_before(result, damage.offset), damage.offset, damage.size)
        stuck = result.end <= start  # nothing but a cut-off record, or the file became shorter than it was
        self.tail = max(result.tail, self._source.size - result.end) if stuck else result.tail
        self.end, self._end_sure = result.end, result.sure

    def _keep_places(self, last: dict[SourceKey, int]) -> None:
        for key, offset in last.items():
            places = self.places.get(key)
            if places is None:
                if len(self.places) >= MAX_KEYS:
                    continue
                places = self.places[key] = array("Q")
            places.append(offset)

    def _add_frame(self, frame: LogFrame, following: int | None) -> None:
        self.findings.add(self._time(frame.at, frame.stamp, following), frame)

    def _time(self, at: int, stamp: int, following: int | None) -> float:
        """Return the time of a record, and note where the clock jumped."""
        clock = self.clock
        jumped = clock.add(at, stamp, following)
        if jumped:
            self.findings.add_jump(clock.now, at)
        return clock.now if jumped is None else clock.elapsed(at, stamp)

    # ---- reading ----

    def find_interval(self, time: float) -> int:
        """Return the number of the last interval that starts at or before a time; 0 for an empty index."""
        return max(0, bisect_right(self.times, time) - 1)

    def interval_of(self, offset: int) -> int:
        """Return the number of the interval in which a record stands; 0 for an empty index."""
        return max(0, bisect_right(self.starts, offset) - 1)

    def read_interval(self, number: int) -> CarefulScan:
        """Return the frames of an interval, each checked, and its damage."""
        start = self.starts[number]
        limit = self.starts[number + 1] if number + 1 < len(self.starts) else self.end
        block = self._source.read(start, limit - start + BEYOND)
        return scan(block, start, limit, final=limit + BEYOND >= self._source.size, sure=bool(self._sure[number]))

    def timed_frames(self, number: int) -> Iterator[tuple[float, LogFrame]]:
        """Yield the frames of an interval with their times, which never go back and stay within the interval.

        A stamp that is later than the next one is wrong: such a frame gets the time of the one before.
        """
        now = self.times[number]
        end = self.times[number + 1] if number + 1 < len(self.times) else self.duration
        for frame, following in with_following(self.read_interval(number).frames):
            if following is None or frame.stamp <= following + 1_000_000:
                now = min(max(now, self.clock.elapsed(frame.at, frame.stamp)), max(now, end))
            yield now, frame

    def time_before(self, result: CarefulScan, offset: int) -> float:
        """Return the time of the last frame before an offset, or that of the interval."""
        at = bisect_left(result.frames, offset, key=lambda frame: frame.at)
        if not at:
            return self.times[self.interval_of(offset)]
        frame = result.frames[at - 1]
        return min(self.duration, self.clock.elapsed(frame.at, frame.stamp))

    def read_frame(self, offset: int) -> LogFrame | None:
        """Return the frame of the record at an offset; None if it is damaged."""
        block = self._source.read(offset, BEYOND)
        frames = scan(block, offset, offset + 1, final=True).frames if len(block) > STAMP else []
        return frames[0] if frames else None


def with_following(frames: list[LogFrame]) -> Iterator[tuple[LogFrame, int | None]]:
    """Yield each frame and the stamp of the next one."""
    for at, frame in enumerate(frames):
        yield frame, frames[at + 1].stamp if at + 1 < len(frames) else None
