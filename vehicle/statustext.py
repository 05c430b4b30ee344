"""STATUSTEXT queues: the most important first, at most 10 messages a second to all, long texts in chunks.

Texts for all ground stations wait in three lanes: CRITICAL and worse, events that change the state of the vehicle, and
other reports. No lane drops or delays a text of a more important one, and each has a log budget of its own. Replies, as
why a request is refused, go to their asker only (vehicle/replies.py).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

import msgspec

from dialects.enums import Severity
from dialects.messages import StatusText
from link.core import Outgoing
from link.protocol.rate import TokenBucket
from vehicle.repeats import RepeatFilter
from vehicle.replies import ReplyQueue, Requester

CHUNK_SIZE = 50
"""Bytes of text in one message (common.xml, STATUSTEXT)."""
RATE, BURST = 10.0, 5.0
"""Messages/s to all, and messages at once: slow links carry telemetry too."""
TEXT_SIZE_MAX = 200
"""Bytes of one text at most: four chunks."""
QUEUE_SIZE = 30
"""Texts that may wait in a lane; beyond that its oldest is dropped, because the newest matter most."""
EVENT_LOG_BURST = 100
"""Texts of the two upper lanes that are logged at once; after them RATE a second."""
RECENT_TEXTS = 32
"""Reports that are remembered to find repeats."""
LIST_MAX = 10
"""Reports of one list that are sent, 1 s of the rate."""
ONCE_KEYS_MAX = 300
"""Keys of one group of `send_once`; beyond that the group is forgotten."""


class _Lane(msgspec.Struct):
    """Texts of one importance."""

    log_bucket: TokenBucket
    waiting: deque[tuple[Severity, str]] = msgspec.field(default_factory=lambda: deque(maxlen=QUEUE_SIZE))


class StatusTextQueue:
    """Queues texts for all ground stations, and replies for the one that asked."""

    def __init__(self, on_text: Callable[[Severity, str], None] = lambda severity, text: None) -> None:
        """`on_text` is called with each whole text, even if no ground station is connected: the log of the daemon."""
        self._on_text = on_text
        self._bucket = TokenBucket(RATE, BURST)
        self._critical = _Lane(TokenBucket(RATE, EVENT_LOG_BURST))
        self._events = _Lane(TokenBucket(RATE, EVENT_LOG_BURST))
        self._reports = _Lane(TokenBucket(RATE, QUEUE_SIZE))
        self._lanes = (self._critical, self._events, self._reports)
        self._replies = ReplyQueue(on_text)
        self._repeats = RepeatFilter(RECENT_TEXTS)
        self._once: dict[str, set[str]] = {}
        """Group, the first word of the key -> keys of `send_once` and `reply_once`."""
        self._number = 0

    def send_event(self, severity: Severity, text: str, now: float) -> None:
        """Queue a text about a change of state; never taken for a repeat: arm, disarm, arm are three texts."""
        self._add(self._events, severity, text, now)

    def send_change(self, severity: Severity, text: str, now: float) -> None:
        """Queue a report of what a request has changed; never taken for a repeat."""
        self._add(self._reports, severity, text, now)

    def send(self, severity: Severity, text: str, now: float) -> None:
        """Queue a report, unless the same text was queued less than REPEAT_AFTER ago."""
        if not self._repeats.is_repeat(text, now):
            self._add(self._reports, severity, text, now)

    def send_list(self, severity: Severity, texts: Sequence[str], now: float) -> None:
        """Queue the first LIST_MAX reports and the number of the others; the log gets all of them in one line."""
        whole = "; ".join(texts)
        if not texts or self._repeats.is_repeat(whole, now):
            return
        if self._events.log_bucket.consume(now):
            self._on_text(severity, whole)
        more = len(texts) - LIST_MAX
        self._reports.waiting.extend((severity, text) for text in texts[:LIST_MAX])
        if more > 0:
            self._reports.waiting.append((severity, f"and {more} more"))

    def send_once(self, key: str, severity: Severity, text: str, now: float) -> None:
        """Queue a report only the first time for its key; `reset_once` allows it again."""
        if self._is_first(key):
            self.send(severity, text, now)

    def reply(self, asker: Requester, severity: Severity, text: str, now: float) -> None:
        """Queue a text, mostly a refusal, for the ground station that sent the request."""
        self._replies.add(asker, severity, text, _cost(text), now)

    def reply_once(self, key: str, asker: Requester, severity: Severity, text: str, now: float) -> None:
        """Queue a reply only the first time for its key; `reset_once` allows it again."""
        if self._is_first(key):
            self.reply(asker, severity, text, now)

    def reset_once(self, group: str) -> None:
        """Allow `send_once` and `reply_once` again for the keys whose first word is `group`."""
        self._once.pop(group, None)

    def pop_due(self, now: float) -> list[StatusText]:
        """Return the messages that may be sent to all now and forget them."""
        messages: list[StatusText] = []
        for lane in self._lanes:
            while lane.waiting:
                if not self._bucket.consume(now, _cost(lane.waiting[0][1])):
                    return messages
                messages += self._chunks(*lane.waiting.popleft())
        return messages

    def pop_replies(self) -> list[Outgoing]:
        """Return the replies to send now, each to its asker, and forget them."""
        return [
            Outgoing(chunk, peer)
            for peer, severity, text in self._replies.pop()
            for chunk in self._chunks(severity, text)
        ]

    def _add(self, lane: _Lane, severity: Severity, text: str, now: float) -> None:
        if severity <= Severity.CRITICAL:
            lane = self._critical
        if lane.log_bucket.consume(now):
            self._on_text(severity, text)
        lane.waiting.append((severity, text))

    def _is_first(self, key: str) -> bool:
        """Return True the first time for a key."""
        keys = self._once.setdefault(key.partition(" ")[0], set())
        if key in keys:
            return False
        if len(keys) >= ONCE_KEYS_MAX:
            keys.clear()
        keys.add(key)
        return True

    def _chunks(self, severity: Severity, text: str) -> list[StatusText]:
        encoded = _encode(text)
        if len(encoded) <= CHUNK_SIZE:
            return [StatusText(severity=severity, text=encoded)]
        self._number = self._number % 65535 + 1  # 0 means "one chunk only"
        # A text that fills its last chunk needs an empty chunk after it: receivers expect more after a full one.
        return [
            StatusText(
                severity=severity,
                text=encoded[start : start + CHUNK_SIZE],
                id=self._number,
                chunk_seq=start // CHUNK_SIZE,
            )
            for start in range(0, len(encoded) + 1, CHUNK_SIZE)
        ]


def _cost(text: str) -> int:
    """Return the number of messages that a text is sent as."""
    return max(1, len(_encode(text)) // CHUNK_SIZE + (len(_encode(text)) > CHUNK_SIZE))


def _encode(text: str) -> bytes:
    return text.encode("utf-8", "replace")[:TEXT_SIZE_MAX]
