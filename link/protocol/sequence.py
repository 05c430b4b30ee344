"""Packet sequence numbers of one sender: which frames are lost, repeated or overtaken, and which runs are apart.

On a slow link urgent frames overtake telemetry (link/transport/priority_queue.py), so that numbers arrive out of order
on purpose. Only within one message id does the order tell which state is the newest.

A sender counts its frames, and it cannot count faster than it sends. So a frame whose number is too far from those
before it belongs to another run of numbers, a `Numbering`: of a program that has restarted, of a second program with
the same ids, or of copies of old frames. The runs are kept apart, so that a vehicle can let one of them drive.

A program that has restarted may begin a little behind the last number of its former run. A number that the silent
former run has used for another frame shows that: no copy and no late frame of that run has one.

Worst case: a flood of frames with any numbers. A sender has NUMBERINGS_MAX runs with _RING digests each, and no more.

Why not simpler: numbers compared modulo 256 make a copy that is 128 to 255 numbers old look new, and five old frames
in a row are a replay as well as a restart (docs/decisions.md).
"""

from __future__ import annotations

import math
from enum import Enum, auto

LATE_WINDOW = 32
"""Frames up to this much older than the newest are late; further back, they belong to another numbering."""
CLOSE = 8
"""Numbers ahead of the newest that a frame may always be: nine frames lost in a row at 10 % loss come once in 10^9."""
RATE_MIN = 5.0
"""Frames/s that every sender is taken to send at least."""
REACH_MAX = 127
"""Numbers ahead that a frame may be after any silence: half of the numbers."""
NUMBERINGS_MAX = 4
"""Numberings of one sender kept apart: a driver, its successor, a second program, and old frames."""
NUMBERING_SILENCE = 5.0
"""s of silence after which a numbering is forgotten."""
CLASH_SILENCE = 0.7
"""s of silence after which a numbering clashes with no other any more, and takes no frames from one in use."""

_WINDOW_BITS = (1 << LATE_WINDOW + 1) - 1
_RING = 64
"""Digests kept of a numbering: a power of two above LATE_WINDOW."""


class FrameOrder(Enum):
    """What the sequence number of a frame tells."""

    NEW = auto()
    """The newest of its message in its numbering."""
    LATE = auto()
    """A newer one of its message was received before."""
    DUPLICATE = auto()
    """This frame was received before, byte for byte."""


NEW = FrameOrder.NEW
"""Shortcut of the usual case: a lookup in an enum costs as much as the rest of accept()."""


class Numbering:
    """One run of packet numbers. `index` counts the numberings of their sender.

    `former`: index of the silent run in whose numbers this one has begun; 0: none.
    """

    __slots__ = ("_digests", "_kinds", "_rate", "_seen", "_window_at", "_window_count", "former", "heard_at", "index",
                 "newest", "received")  # fmt: skip

    def __init__(self, index: int, sequence: int, message_id: int, digest: int, now: float, *, former: int = 0) -> None:
        self.index = index
        self.former = former
        self.newest = sequence
        self.heard_at = now
        self.received = 1
        self._seen = 1
        """Bit n: number n before the newest was received."""
        self._kinds = {message_id: sequence}
        """Message id -> its newest number."""
        self._digests = [0] * _RING
        self._digests[sequence % _RING] = digest
        self._rate = RATE_MIN
        self._window_at, self._window_count = now, 1

    def is_in_use(self, now: float) -> bool:
        """Return whether it was heard within CLASH_SILENCE."""
        return now - self.heard_at <= CLASH_SILENCE

    def distance(self, sequence: int, now: float) -> int | None:
        """Return how far a number is from the newest, negative for behind; None if it is of another numbering."""
        ahead = (sequence - self.newest) & 0xFF
        if ahead > 0xFF - LATE_WINDOW:
            return ahead - 0x100
        rate = max(self._rate, self._window_count)
        return ahead if ahead <= min(REACH_MAX, CLOSE + 2 * rate * (now - self.heard_at)) else None

    def advance(self, sequence: int, message_id: int, digest: int, now: float) -> None:
        """Handle a frame ahead of all others."""
        self._seen = (self._seen << ((sequence - self.newest) & 0xFF) | 1) & _WINDOW_BITS
        self.newest = sequence
        self._kinds[message_id] = sequence
        self._digests[sequence % _RING] = digest
        self.heard_at = now
        self.received += 1
        self._window_count += 1
        if now - self._window_at >= 1.0:
            self._begin_window(now)

    def fill(self, sequence: int, message_id: int, digest: int, now: float) -> FrameOrder | None:
        """Handle a frame behind the newest; None if another frame had its number."""
        if self.has_taken(sequence, digest):
            return FrameOrder.DUPLICATE
        bit = 1 << ((self.newest - sequence) & 0xFF)
        if self._seen & bit:
            return None
        self._seen |= bit
        self._digests[sequence % _RING] = digest
        last = self._kinds.get(message_id)
        if last is not None and (last - sequence) & 0xFF <= LATE_WINDOW:
            return FrameOrder.LATE
        self._kinds[message_id] = sequence
        self.heard_at = now
        self.received += 1
        self._window_count += 1
        if now - self._window_at >= 1.0:
            self._begin_window(now)
        return NEW

    def has_received(self, message_id: int) -> bool:
        """Return whether it has had this message."""
        return message_id in self._kinds

    def has_taken(self, sequence: int, digest: int) -> bool:
        """Return whether this frame was received before, byte for byte, as one of the newest LATE_WINDOW + 1."""
        bit = 1 << ((self.newest - sequence) & 0xFF)
        return self._seen & bit != 0 and self._digests[sequence % _RING] == digest

    def _begin_window(self, now: float) -> None:
        """Measure the rate of the frames before this one, which is the first of the next window."""
        self._rate = max(RATE_MIN, (self._window_count - 1) / (now - self._window_at))
        self._window_at, self._window_count = now, 1


class SequenceTracker:
    """Frames of one system and component from one address. `sequence` is that of the first frame, 0..255.

    `digest` is equal for equal frames and hardly ever for others; `now` in s.
    """

    __slots__ = ("_begun", "_gaps_until", "_numberings", "clash", "lost", "numbering", "received")

    def __init__(self, sequence: int, message_id: int, digest: int, now: float) -> None:
        self.received = 1
        self.lost = 0
        self.numbering = Numbering(1, sequence, message_id, digest, now)
        """That of the newest frame."""
        self.clash = False
        """Two senders count here: the number of the newest frame was that of another one, or another numbering that
        is in use is so close that frames of one pass for frames of the other."""
        self._numberings = [self.numbering]
        self._begun = 1
        self._gaps_until = -math.inf

    def expect_gaps(self, until: float) -> None:
        """Set the time until which the sender leaves frames out on purpose: missing numbers are not lost."""
        self._gaps_until = until

    def has_received(self, message_id: int) -> bool:
        """Return whether a run of numbers that is not forgotten has had this message."""
        return any(each.has_received(message_id) for each in self._numberings)

    def accept(self, sequence: int, message_id: int, digest: int, now: float) -> FrameOrder:
        """Count a frame and return its order; `numbering` and `clash` are then those of this frame."""
        current = self.numbering
        ahead = (sequence - current.newest) & 0xFF
        gaps = now <= self._gaps_until
        if (
            0 < ahead <= (REACH_MAX if gaps else CLOSE)
            and len(self._numberings) == 1
            and now - current.heard_at <= NUMBERING_SILENCE
        ):
            self.lost += 0 if gaps else ahead - 1
            self.received += 1
            self.clash = False
            current.advance(sequence, message_id, digest, now)
            return NEW
        lost = self.lost
        order = self._accept_any(sequence, message_id, digest, now)
        if gaps:
            self.lost = min(lost, self.lost)
        return order

    def _accept_any(self, sequence: int, message_id: int, digest: int, now: float) -> FrameOrder:
        self._numberings = [each for each in self._numberings if now - each.heard_at <= NUMBERING_SILENCE]
        near = [
            (not each.is_in_use(now), abs(distance), distance, each)
            for each in self._numberings
            if (distance := each.distance(sequence, now)) is not None
        ]
        if not near:
            return self._begin(sequence, message_id, digest, now)
        _, _, distance, self.numbering = min(near, key=lambda each: each[:2])  # one in use goes before a silent one
        if distance <= 0:
            return self._accept_old(sequence, message_id, digest, now)
        self.lost += distance - 1
        self.received += 1
        self.numbering.advance(sequence, message_id, digest, now)
        self.clash = self._is_crossed(now) or self._is_of_former(sequence, digest)
        return NEW

    def _accept_old(self, sequence: int, message_id: int, digest: int, now: float) -> FrameOrder:
        order = self.numbering.fill(sequence, message_id, digest, now)
        if order is None and not self.numbering.is_in_use(now):
            return self._begin(sequence, message_id, digest, now, former=self.numbering.index)
        self.clash = order is None or (order is NEW and (self._is_crossed(now) or self._is_of_former(sequence, digest)))
        if order is not FrameOrder.DUPLICATE and order is not None:
            self.lost = max(0, self.lost - 1)
        self.received += order is None or order is NEW
        return NEW if order is None else order

    def _begin(self, sequence: int, message_id: int, digest: int, now: float, *, former: int = 0) -> FrameOrder:
        if len(self._numberings) >= NUMBERINGS_MAX:
            self._numberings.remove(min(self._numberings, key=lambda each: each.received))
        self._begun += 1
        self.numbering = Numbering(self._begun, sequence, message_id, digest, now, former=former)
        self._numberings.append(self.numbering)
        self.received += 1
        self.clash = False
        return NEW

    def _is_crossed(self, now: float) -> bool:
        """Return whether another numbering in use has its newest number within CLOSE of this one."""
        newest = self.numbering.newest
        return any(
            (each.newest - newest + CLOSE) & 0xFF <= 2 * CLOSE
            for each in self._numberings
            if each is not self.numbering and each.is_in_use(now)
        )

    def _is_of_former(self, sequence: int, digest: int) -> bool:
        """Return whether the run before this one had the frame: a copy of it passes for a frame of this one."""
        former = self.numbering.former
        return any(each.index == former and each.has_taken(sequence, digest) for each in self._numberings)
