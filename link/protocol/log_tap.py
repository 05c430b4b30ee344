"""What a host hears and says, as frames for a recorder: each frame that arrives, and each message of ours once.

Our own are numbered for the log, as for one more peer that loses nothing, so tools that count losses count none. Left
out are keys (SETUP_SIGNING), and files and logs on their way to somebody: a log that is read while it is written would
grow by what it is read.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from dialects import codec
from dialects.traits import SECRET, UNLOGGED
from link.protocol.frame import Frame


class LogTap:
    """Hands frames and their times to `add`."""

    def __init__(self, add: Callable[[float, Sequence[bytes]], None], *, system: int, component: int) -> None:
        self._add = add
        self._ids = (system, component)
        self._sequence = 0

    def record_received(self, frames: Sequence[Frame], now: float) -> None:
        """Frames that were found whole, of anybody."""
        self._add(now, [raw for message_id, _, _, _, raw in frames if message_id not in SECRET])

    def record_sent(self, message_id: int, payload: bytes, now: float) -> None:
        """A message of ours."""
        if message_id not in UNLOGGED:
            self._add(now, (codec.frame(message_id, payload, self._sequence, *self._ids),))
            self._sequence = (self._sequence + 1) & 0xFF
