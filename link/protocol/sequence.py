"""Sequence numbers of one sender: which frames are lost, repeated, or overtaken by a newer one.

On a slow link urgent frames overtake telemetry (link/transport/priority_queue.py), so that numbers arrive out of order
on purpose. Only within one message id does the order tell which state is the newest.
"""

from __future__ import annotations

from enum import Enum, auto

LATE_WINDOW = 32
"""Frames up to this much older than the newest are late; further back, the sender has restarted."""
RESTART_AFTER = 4
"""Old frames in a row after which the sender has restarted just behind its old number."""

_WINDOW_BITS = (1 << LATE_WINDOW + 1) - 1


class FrameOrder(Enum):
    """What the sequence number of a frame tells."""

    NEW = auto()
    """The newest of its message."""
    LATE = auto()
    """A newer one of its message was received before."""
    DUPLICATE = auto()
    """This number was received before."""


NEW = FrameOrder.NEW
"""Shortcut of the usual case: a lookup in an enum costs as much as the rest of accept()."""


class SequenceTracker:
    """Frames of one system and component from one address. `sequence` is that of the first frame, 0..255."""

    __slots__ = ("_kinds", "_newest", "_old_run", "_seen", "lost", "received")

    def __init__(self, sequence: int, message_id: int) -> None:
        self.received = 1
        self.lost = 0
        self._newest = sequence
        self._seen = 1
        """Bit n: number n before the newest was received."""
        self._kinds = {message_id: sequence}
        """Message id -> its newest number."""
        self._old_run = 0

    def accept(self, sequence: int, message_id: int) -> FrameOrder:
        """Count a frame and return its order."""
        ahead = (sequence - self._newest) & 0xFF
        if ahead == 0:
            return FrameOrder.DUPLICATE
        if ahead > 0xFF - LATE_WINDOW:
            return self._accept_old(sequence, message_id, 256 - ahead)
        if ahead > 1:
            self.lost += ahead - 1
        self._newest = sequence
        self._seen = (self._seen << ahead | 1) & _WINDOW_BITS
        self._kinds[message_id] = sequence
        self._old_run = 0
        self.received += 1
        return NEW

    def _accept_old(self, sequence: int, message_id: int, behind: int) -> FrameOrder:
        seen = self._seen >> behind & 1
        last = self._kinds.get(message_id)
        in_order = last is None or (last - sequence) & 0xFF > LATE_WINDOW
        if not seen and in_order:
            self._fill(behind)
            return self._new(sequence, message_id)
        self._old_run += 1
        if self._old_run > RESTART_AFTER:
            self._newest, self._seen = sequence, 1
            self._kinds.clear()
            return self._new(sequence, message_id)
        if seen:
            return FrameOrder.DUPLICATE
        self._fill(behind)
        return FrameOrder.LATE

    def _fill(self, behind: int) -> None:
        self._seen |= 1 << behind
        self.lost = max(0, self.lost - 1)

    def _new(self, sequence: int, message_id: int) -> FrameOrder:
        self._kinds[message_id] = sequence
        self._old_run = 0
        self.received += 1
        return FrameOrder.NEW
