"""A station that hears a recorded vehicle, behind the screen: the time of the recording passes in `run` only."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from groundstation.intents.session import RenewLease
from groundstation.intents.union import AnyIntent
from groundstation.station.component import COMPONENT
from groundstation.station.station import Station
from link.protocol.channel import Channel
from link.tlog.tlog import Record, read_records
from tests.groundstation.ui.examples import Recorder

RECORDINGS = Path(__file__).parents[1] / "recordings"
SYSTEM = 254
"""Ours: the ground station of the recording is 255."""
TICK = 0.05
LEASE = RenewLease()


class RecordedStation:
    """A station behind `screen`, on whose only link the recording arrives. What it sends goes nowhere."""

    def __init__(self, file: str) -> None:
        self.station = Station(["udpin:127.0.0.1:14550"], system=SYSTEM)
        self.screen = Recorder(self._handle)
        self.now = 0.0
        self.heard = 0
        """Messages of the recording that were handled."""
        self._records = _timed((RECORDINGS / file).read_bytes())
        self._next = next(self._records, None)
        self._channel = Channel("recording", 0, system=SYSTEM, component=COMPONENT)

    @property
    def ended(self) -> bool:
        """The recording is over."""
        return self._next is None

    def run(self, seconds: float) -> None:
        """Let time pass, and offer a snapshot."""
        end = self.now + seconds
        while self.now < end:
            self.now = min(end, self.now + TICK)
            self.station.handle_intent(LEASE, self.now)
            self._hear()
            self.station.tick(self.now)
            self.station.messages_to_send()
        self.station.views.send_due(self.screen.offer_view, self.now, 0.0)
        self.screen.offer(self.station.snapshot(self.now, 0.0))

    def _handle(self, *intents: AnyIntent) -> None:
        for intent in intents:
            self.station.handle_intent(intent, self.now)

    def _hear(self) -> None:
        while self._next is not None and self._next[0] <= self.now:
            for received in self._channel.receive(self._next[1].raw, "recording", self.now):
                self.station.receive(received, self.now)
                self.heard += 1
            self._next = next(self._records, None)


def _timed(data: bytes) -> Iterator[tuple[float, Record]]:
    """Yield each record with its time, s since the first one."""
    start: int | None = None
    for record in read_records(data):
        start = record.microseconds if start is None else start
        yield (record.microseconds - start) / 1e6, record
