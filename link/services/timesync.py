"""TIMESYNC and PING: round trip time for the client, the reply for the server.

A reply names its recipient; older programs do not know the field and leave it 0, which means everyone. Source:
https://mavlink.io/en/services/timesync.html.
"""

from __future__ import annotations

import math
from collections import deque

from dialects.messages import Ping, Timesync
from link.core import Outgoing, Peer, Received

OFFSETS = 16
"""Replies of which the quickest tells the clock: two quartz clocks part by 1 ms in that time."""
RESTARTED = 0.05
"""s of a change of the clock beyond what both replies allow: it is another clock."""
MEMORY = 4
"""Requests that may still be answered: at one a second an older reply says nothing about the present."""
TRIPS = 16
"""Peers whose round trips are kept."""


class TimesyncClient:
    """Sends a request every `period` s as `system`, and measures the round trip to one vehicle, on each path to it."""

    def __init__(self, system: int, period: float = 1.0) -> None:
        self.round_trip: float | None = None
        """Newest round trip, s; of several paths that of the first answer to the newest request."""
        self.jitter: float | None = None
        """Smoothed difference between one round trip and the next, s (weights of RFC 3550)."""
        self.offset: float | None = None
        """s by which the clock of the vehicle is ahead of ours, by the quickest of the newest replies."""
        self.offset_error = 0.0
        """s by which that may be wrong: half of that round trip."""
        self._offsets: deque[tuple[float, float]] = deque(maxlen=OFFSETS)
        self._system = system
        self._period = period
        self._due = 0.0
        self._sent_at: dict[int, float] = {}
        self._answered: set[tuple[int, Peer]] = set()
        self._first_answered = -1
        """The newest request that was answered."""
        self._trips: dict[Peer, tuple[float, float]] = {}
        """Peer -> its newest round trip, and when it was measured, s."""
        self._outbox: list[Outgoing] = []

    def tick(self, now: float) -> None:
        """Send a request when it is due."""
        if now < self._due:
            return
        self._due = now + self._period
        stamp = int(now * 1e9)
        self._sent_at[stamp] = now
        while len(self._sent_at) > MEMORY:
            oldest = next(iter(self._sent_at))
            del self._sent_at[oldest]
            self._answered = {each for each in self._answered if each[0] != oldest}
        self._outbox.append(Outgoing(Timesync(tc1=0, ts1=stamp)))

    def receive(self, received: Received, now: float) -> None:
        """Handle a reply; requests and replies to others are ignored."""
        message = received.message
        if not isinstance(message, Timesync) or message.tc1 == 0 or message.target_system not in (0, self._system):
            return
        sent_at = self._sent_at.get(message.ts1)
        if sent_at is None or (message.ts1, received.peer) in self._answered:
            return
        self._answered.add((message.ts1, received.peer))
        trip = now - sent_at
        self._note_offset(message.tc1 / 1e9 - (sent_at + now) / 2, trip / 2)
        self._trips.pop(received.peer, None)
        self._trips[received.peer] = (trip, now)
        if len(self._trips) > TRIPS:
            del self._trips[next(iter(self._trips))]
        if message.ts1 <= self._first_answered:
            return
        self._first_answered = message.ts1
        before, self.round_trip = self.round_trip, trip
        if before is not None:
            self.jitter = (self.jitter or 0.0) + (abs(self.round_trip - before) - (self.jitter or 0.0)) / 16

    def round_trip_of(self, peer: Peer, now: float) -> float | None:
        """Return the round trip over one path, s; None if it has not answered for MEMORY requests."""
        trip, at = self._trips.get(peer, (0.0, -math.inf))
        return trip if now - at <= MEMORY * self._period + trip else None

    def _note_offset(self, offset: float, error: float) -> None:
        if self.offset is not None and abs(offset - self.offset) > error + self.offset_error + RESTARTED:
            self._offsets.clear()  # another vehicle, or one that has restarted
        self._offsets.append((error, offset))
        self.offset_error, self.offset = min(self._offsets)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them."""
        outbox, self._outbox = self._outbox, []
        return outbox


def handle_request(received: Received, now: float, ids: tuple[int, int]) -> list[Outgoing]:
    """Return the reply to a broadcast PING, or to a TIMESYNC request for all or `ids` (system, component).

    Returns nothing for any other message: a TIMESYNC with tc1 and a PING with a target are replies themselves.
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
