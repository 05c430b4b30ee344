"""Passes each frame that arrives, and each message of ours once, to a recorder.

Our own messages are numbered for the log as those of one peer that loses nothing, so that tools that count losses count
none. Left out are messages with the traits SECRET and UNLOGGED (dialects/traits.py).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from dialects import codec
from dialects.traits import SECRET, UNLOGGED
from link.protocol.frame import Frame


class LogTap:
    """Passes frames and their times to `add`."""

    def __init__(self, add: Callable[[float, Sequence[bytes]], None], *, system: int, component: int) -> None:
        self._add = add
        self._ids = (system, component)
        self._sequence = 0

    def record_received(self, frames: Sequence[Frame], now: float) -> None:
        """Record complete frames of any sender."""
        self._add(now, [raw for message_id, _, _, _, raw in frames if message_id not in SECRET])

    def record_sent(self, message_id: int, payload: bytes, now: float) -> None:
        """Record one of our own messages."""
        if message_id not in UNLOGGED:
            self._add(now, (codec.frame(message_id, payload, self._sequence, *self._ids),))
            self._sequence = (self._sequence + 1) & 0xFF
