"""What the driver reads: STATUSTEXT in order, without repeats, at most 10 a second, long ones in chunks."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from dialects.enums import Severity
from dialects.messages import StatusText
from link.protocol.rate import TokenBucket

CHUNK_SIZE = 50
"""Bytes of text in one message (common.xml, STATUSTEXT)."""
RATE, BURST = 10.0, 5.0
"""Messages a second, and at once: slow links carry telemetry too (protocol.md 1.7)."""
TEXT_SIZE_MAX = 200
"""Bytes of one text: four chunks."""
QUEUE_SIZE = 30
"""Messages that may wait; then the oldest is dropped, for a driver needs the newest."""
REPEAT_AFTER = 3.0
"""s in which the same text is not said again: as long as a repeated command is the same (link/services/command/server.py)."""


class StatusTextQueue:
    """Says things to whoever drives."""

    def __init__(self, told: Callable[[Severity, str], None] = lambda severity, text: None) -> None:
        """`told` hears each text whole, also where no ground station listens: the daemon's own log."""
        self._on_text = told
        self._log_bucket = TokenBucket(RATE, QUEUE_SIZE)
        self._bucket = TokenBucket(RATE, BURST)
        self._waiting: deque[StatusText] = deque(maxlen=QUEUE_SIZE)
        self._sent_at: dict[str, float] = {}
        self._once: set[str] = set()
        self._number = 0

    def send(self, severity: Severity, text: str, now: float) -> None:
        """Queue a text, unless the same was said a moment ago."""
        self._sent_at = {each: at for each, at in self._sent_at.items() if now - at < REPEAT_AFTER}
        if text in self._sent_at:
            return
        self._sent_at[text] = now
        if self._log_bucket.consume(now):
            self._on_text(severity, text)
        self._waiting.extend(self._chunks(severity, text.encode("utf-8", "replace")[:TEXT_SIZE_MAX]))

    def send_once(self, key: str, severity: Severity, text: str, now: float) -> None:
        """Say it the first time only; `forget` makes it new again."""
        if key not in self._once:
            self._once.add(key)
            self.send(severity, text, now)

    def reset_once(self, prefix: str) -> None:
        """Keys of `say_once` that begin with `prefix` may be said again."""
        self._once = {key for key in self._once if not key.startswith(prefix)}

    def pop_due(self, now: float) -> list[StatusText]:
        """What may be sent now; empties what it returns."""
        messages = []
        while self._waiting and self._bucket.consume(now):
            messages.append(self._waiting.popleft())
        return messages

    def _chunks(self, severity: Severity, text: bytes) -> list[StatusText]:
        if len(text) <= CHUNK_SIZE:
            return [StatusText(severity=severity, text=text)]
        self._number = self._number % 65535 + 1  # 0 means "not in chunks"
        # A text that fills its last chunk needs an empty one behind it: a receiver takes a full chunk for not the last.
        return [
            StatusText(
                severity=severity, text=text[start : start + CHUNK_SIZE], id=self._number, chunk_seq=start // CHUNK_SIZE
            )
            for start in range(0, len(text) + 1, CHUNK_SIZE)
        ]
