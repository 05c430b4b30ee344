"""MessageKind: one kind of message of one source. Counting a message must cost next to nothing."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

import msgspec

from dialects.codec import CRC_SIZE, HEADER_V2, EncodeError, encode_payload
from dialects.messages import Message

BUCKET = 0.25
"""s between two looks at the counters, from which rates come: no record of each message is needed."""

BUCKETS = 12
WINDOW = BUCKET * BUCKETS
"""s over which rates are counted: a 1 Hz message then shows as 1.0 and not as 0 or 1."""

Tap = Callable[[Message, float], None]
"""Gets each message of a kind, with the time."""


class MessageKind(msgspec.Struct):
    """Counter and newest message of a kind."""

    newest: Message
    at: float = 0.0
    """When it arrived or was sent, s."""
    count: int = 0
    taps: tuple[Tap, ...] = ()
    """Who gets each message."""
    _counts: deque[int] = msgspec.field(default_factory=lambda: deque([0] * (BUCKETS + 1), BUCKETS + 1))
    """`count` at the ends of the last buckets."""

    def end_bucket(self) -> None:
        """Keep the count at the end of a bucket."""
        self._counts.append(self.count)

    @property
    def rate(self) -> float:
        """Messages/s over the last WINDOW that has ended."""
        return (self._counts[-1] - self._counts[0]) / WINDOW

    @property
    def payload(self) -> bytes:
        """Payload of the newest message, without its trailing zeros; empty if it has none that can be encoded."""
        try:
            return encode_payload(self.newest)
        except EncodeError:
            return b""

    @property
    def length(self) -> int:
        """Bytes of the newest frame, as MAVLink 2 without a signature."""
        payload = self.payload
        return HEADER_V2 + len(payload) + CRC_SIZE if payload else 0
