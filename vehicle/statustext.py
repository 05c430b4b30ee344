"""What the driver reads: STATUSTEXT in order, without repeats, at most 10 a second, long ones in chunks."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from dialects.enums import Severity
from dialects.messages import StatusText
from link.protocol.rate import TokenBucket

CHUNK = 50
"""Bytes of text in one message (common.xml, STATUSTEXT)."""
RATE, BURST = 10.0, 5.0
"""Messages a second, and at once: slow links carry telemetry too (protocol.md 1.7)."""
LONGEST = 200
"""Bytes of one text: four chunks."""
WAITING = 30
"""Messages that may wait; then the oldest is dropped, for a driver needs the newest."""
REPEAT_AFTER = 3.0
"""s in which the same text is not said again: as long as a repeated command is the same (link/services/command/server.py)."""


class Texts:
    """Says things to whoever drives."""

    def __init__(self, told: Callable[[Severity, str], None] = lambda severity, text: None) -> None:
        """`told` hears each text whole, also where no ground station listens: the daemon's own log."""
        self._told = told
        self._log_bucket = TokenBucket(RATE, WAITING)
        self._bucket = TokenBucket(RATE, BURST)
        self._waiting: deque[StatusText] = deque(maxlen=WAITING)
        self._said: dict[str, float] = {}
        self._once: set[str] = set()
        self._number = 0

    def say(self, severity: Severity, text: str, now: float) -> None:
        """Queue a text, unless the same was said a moment ago."""
        self._said = {each: at for each, at in self._said.items() if now - at < REPEAT_AFTER}
        if text in self._said:
            return
        self._said[text] = now
        if self._log_bucket.take(now):
            self._told(severity, text)
        self._waiting.extend(self._chunks(severity, text.encode("utf-8", "replace")[:LONGEST]))

    def say_once(self, key: str, severity: Severity, text: str, now: float) -> None:
        """Say it the first time only; `forget` makes it new again."""
        if key not in self._once:
            self._once.add(key)
            self.say(severity, text, now)

    def forget(self, prefix: str) -> None:
        """Keys of `say_once` that begin with `prefix` may be said again."""
        self._once = {key for key in self._once if not key.startswith(prefix)}

    def due(self, now: float) -> list[StatusText]:
        """What may be sent now; empties what it returns."""
        messages = []
        while self._waiting and self._bucket.take(now):
            messages.append(self._waiting.popleft())
        return messages

    def _chunks(self, severity: Severity, text: bytes) -> list[StatusText]:
        if len(text) <= CHUNK:
            return [StatusText(severity=severity, text=text)]
        self._number = self._number % 65535 + 1  # 0 means "not in chunks"
        # A text that fills its last chunk needs an empty one behind it: a receiver takes a full chunk for not the last.
        return [
            StatusText(severity=severity, text=text[start : start + CHUNK], id=self._number, chunk_seq=start // CHUNK)
            for start in range(0, len(text) + 1, CHUNK)
        ]
