"""TIMESYNC and PING: round trip time for the client, the echo for the server (mavlink.io/en/services/timesync.html).

An answer names whom it is for; older programs know no such field and leave it 0, which is taken for everybody.
"""

from __future__ import annotations

from dialects.messages import Ping, Timesync
from link.core import Outgoing, Received

MEMORY = 4
"""Requests that may still be answered: at one a second an answer older than that says nothing about now."""


class TimesyncClient:
    """Asks once a `period` s for `system` and keeps the smoothed round trip to one vehicle."""

    def __init__(self, system: int, period: float = 1.0) -> None:
        self.round_trip: float | None = None
        """Newest round trip, s."""
        self.jitter: float | None = None
        """Smoothed difference between one round trip and the next, s (RFC 3550's weights)."""
        self._system = system
        self._period = period
        self._due = 0.0
        self._asked: dict[int, float] = {}
        self._outbox: list[Outgoing] = []

    def tick(self, now: float) -> None:
        """Ask when it is time."""
        if now < self._due:
            return
        self._due = now + self._period
        stamp = int(now * 1e9)
        self._asked[stamp] = now
        while len(self._asked) > MEMORY:
            del self._asked[next(iter(self._asked))]
        self._outbox.append(Outgoing(Timesync(tc1=0, ts1=stamp)))

    def receive(self, received: Received, now: float) -> None:
        """Take an answer; requests and answers to others are ignored."""
        message = received.message
        if not isinstance(message, Timesync) or message.tc1 == 0 or message.target_system not in (0, self._system):
            return
        asked = self._asked.pop(message.ts1, None)
        if asked is None:
            return
        before, self.round_trip = self.round_trip, now - asked
        if before is not None:
            self.jitter = (self.jitter or 0.0) + (abs(self.round_trip - before) - (self.jitter or 0.0)) / 16

    def messages_to_send(self) -> list[Outgoing]:
        """What to send now; empties what it returns."""
        outbox, self._outbox = self._outbox, []
        return outbox


def handle_request(received: Received, now: float, ids: tuple[int, int]) -> list[Outgoing]:
    """The echo to a PING for everybody, or to a TIMESYNC request for everybody or `ids` (system, component).

    Nothing for anything else: a TIMESYNC with tc1 and a PING with a target are answers.
    """
    match received.message:
        case Timesync(tc1=0) as question if _for_us(question, ids):
            return [Outgoing(Timesync(int(now * 1e9), question.ts1, *_sender(received)), received.peer)]
        case Ping(target_system=0) as ping:
            return [Outgoing(Ping(ping.time_usec, ping.seq, *_sender(received)), received.peer)]
        case _:
            return []


def _for_us(question: Timesync, ids: tuple[int, int]) -> bool:
    return question.target_system in (0, ids[0]) and question.target_component in (0, ids[1])


def _sender(received: Received) -> tuple[int, int]:
    return received.system, received.component
