"""STATUSTEXT queue: in order, without repeats, at most 10 messages a second, long texts in chunks."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from dialects.enums import Severity
from dialects.messages import StatusText
from link.protocol.rate import TokenBucket

CHUNK_SIZE = 50
"""Bytes of text in one message (common.xml, STATUSTEXT)."""
RATE, BURST = 10.0, 5.0
"""Messages/s, and messages at once: slow links carry telemetry too."""
TEXT_SIZE_MAX = 200
"""Bytes of one text at most: four chunks."""
QUEUE_SIZE = 30
"""Messages that may wait; beyond that the oldest is dropped, because the newest matter most."""
REPEAT_AFTER = 3.0
"""s in which the same text is not sent again: as long as a command counts as repeated (PROGRESS_TIMEOUT in
link/services/command/server.py)."""


class StatusTextQueue:
    """Queues texts for all ground stations."""

    def __init__(self, on_text: Callable[[Severity, str], None] = lambda severity, text: None) -> None:
        """`on_text` is called with each whole text, even if no ground station is connected: the log of the daemon."""
        self._on_text = on_text
        self._log_bucket = TokenBucket(RATE, QUEUE_SIZE)
        self._bucket = TokenBucket(RATE, BURST)
        self._waiting: deque[StatusText] = deque(maxlen=QUEUE_SIZE)
        self._sent_at: dict[str, float] = {}
        self._once: set[str] = set()
        self._number = 0

    def send(self, severity: Severity, text: str, now: float) -> None:
        """Queue a text, unless the same text was queued less than REPEAT_AFTER ago."""
        self._sent_at = {each: at for each, at in self._sent_at.items() if now - at < REPEAT_AFTER}
        if text in self._sent_at:
            return
        self._sent_at[text] = now
        if self._log_bucket.consume(now):
            self._on_text(severity, text)
        self._waiting.extend(self._chunks(severity, text.encode("utf-8", "replace")[:TEXT_SIZE_MAX]))

    def send_once(self, key: str, severity: Severity, text: str, now: float) -> None:
        """Queue a text only the first time for its key; `reset_once` allows it again."""
        if key not in self._once:
            self._once.add(key)
            self.send(severity, text, now)

    def reset_once(self, prefix: str) -> None:
        """Allow `send_once` again for keys that start with `prefix`."""
        self._once = {key for key in self._once if not key.startswith(prefix)}

    def pop_due(self, now: float) -> list[StatusText]:
        """Return the messages that may be sent now and forget them."""
        messages = []
        while self._waiting and self._bucket.consume(now):
            messages.append(self._waiting.popleft())
        return messages

    def _chunks(self, severity: Severity, text: bytes) -> list[StatusText]:
        if len(text) <= CHUNK_SIZE:
            return [StatusText(severity=severity, text=text)]
        self._number = self._number % 65535 + 1  # 0 means "one chunk only"
        # A text that fills its last chunk needs an empty chunk after it: receivers expect more after a full one.
        return [
            StatusText(
                severity=severity, text=text[start : start + CHUNK_SIZE], id=self._number, chunk_seq=start // CHUNK_SIZE
            )
            for start in range(0, len(text) + 1, CHUNK_SIZE)
        ]
