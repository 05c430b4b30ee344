"""Feeds a station with the frames of a log, in the log's time. It has no links: what it would send is dropped."""

from __future__ import annotations

from collections.abc import Callable

from dialects.axes import NEUTRAL, parse_axes
from dialects.codec import CRC_EXTRA, decode_frame
from dialects.enums import OperatorFlag
from dialects.enums import StationEventKind as Kind
from dialects.messages import (
    Heartbeat,
    ManualControl,
    Message,
    RoverOperatorPresence,
    RoverStationEvent,
    decode_text,
)
from groundstation.station.station import Station
from link.core import LinkReport, Peer, Received, SourceCount
from link.tlog.scan import LogFrame

BASE = 1000.0
"""s of the station's clock at the start of a log: times before it count as "never"."""

TICK = 0.1
"""s of log time between two ticks of the station."""

DEMAND_SHOWN = 1.0
"""s for which a demand is shown that none follows."""

REPORT = 1.0
"""s of log time between two reports of the link."""

MOST_LOST = 128

DEMAND_IDS = (ManualControl.id, RoverOperatorPresence.id, RoverStationEvent.id)

BuildStation = Callable[[int, float], Station]
"""Returns a new station; called with its system id and its time."""


class StationFeed:
    """One station at one moment of a log. `own`: the ground station whose frames count as sent, or None."""

    def __init__(self, name: str, build: BuildStation, own: tuple[int, int] | None, time: float) -> None:
        self.station = build(own[0] if own else 255, BASE)
        self._name = name
        self._own = own
        self._peer = Peer(0, name)
        self._tick_due = self._report_due = time
        self._sequences: dict[tuple[int, int], int] = {}
        self._counts: dict[tuple[int, int], list[int]] = {}
        self._frames = self._bytes = 0
        self._demand_until = 0.0
        self._keys: dict[str, None] = {}

    @property
    def keys(self) -> tuple[str, ...]:
        """Drive keys that counted as held, as the ground station noted them; in logs of others there are none."""
        return tuple(self._keys)

    def prime(self, frame: LogFrame, time: float) -> None:
        """Give a frame from before, in the order of time; nothing happens between them. Demands are over by now."""
        if frame.message_id not in DEMAND_IDS:
            self._give(frame, time)

    def give(self, frame: LogFrame, time: float) -> None:
        """Let time pass up to a frame, and give it."""
        self.pass_time(time)
        self._count(frame)
        self._give(frame, time)

    def pass_time(self, time: float) -> None:
        """Tick up to a time; a long silence has no more than 100 ticks."""
        step = max(TICK, (time - self._tick_due) / 100)
        while self._tick_due <= time:
            self._tick(self._tick_due)
            self._tick_due += step

    def _tick(self, time: float) -> None:
        station = self.station
        if BASE + time >= self._demand_until:
            station.operator.record_demand(NEUTRAL)
            self._keys.clear()
        station.tick(BASE + time)
        if time >= self._report_due:
            self._report_due = time + REPORT
            station.observe([self._report()], BASE + time)
        station.messages_to_send()  # dropped: a replay has no links

    def _report(self) -> LinkReport:
        sources = {source: SourceCount(received, lost) for source, (received, lost) in self._counts.items()}
        return LinkReport(
            self._name, peers=1, frames=self._frames, bytes_received=self._bytes, sources=sources, watch_only=True
        )

    def _count(self, frame: LogFrame) -> None:
        source = frame.system, frame.component
        if source == self._own:
            return
        self._frames += 1
        self._bytes += len(frame.raw)
        counts = self._counts.setdefault(source, [0, 0])
        counts[0] += 1
        before = self._sequences.get(source)
        self._sequences[source] = frame.sequence
        if before is not None and 0 < (lost := (frame.sequence - before - 1) & 0xFF) < MOST_LOST:
            counts[1] += lost

    def _give(self, frame: LogFrame, time: float) -> None:
        if frame.message_id not in CRC_EXTRA:
            return
        message, now = decode_frame(frame.message_id, frame.raw), BASE + time
        if (frame.system, frame.component) == self._own:
            self._give_sent(message, frame.sequence, now)
        else:
            received = Received(message, frame.system, frame.component, frame.sequence, self._peer, introduced=True)
            self.station.receive(received, now)
            if isinstance(message, Heartbeat) and (contact := self.station.fleet.get(frame.system)) is not None:
                self.station.services.services_of(contact)
            self.station.messages_to_send()

    def _give_sent(self, message: Message, sequence: int, now: float) -> None:
        self.station.handle_sent(message, sequence, now)
        if isinstance(message, ManualControl):
            self._show_demand(message, message.target, now)
        elif isinstance(message, RoverStationEvent):
            self._show_keys(message, now)
        elif isinstance(message, RoverOperatorPresence) and message.flags & OperatorFlag.AXES:
            self._show_demand(message, message.target_system, now)

    def _show_demand(self, message: ManualControl | RoverOperatorPresence, target: int, now: float) -> None:
        contact = self.station.fleet.get(target)
        if contact is not None and contact is self.station.fleet.selected:
            axes = parse_axes(message, contact.choose_axes(NEUTRAL))
            self.station.operator.record_demand(axes or NEUTRAL)
            self._demand_until = now + DEMAND_SHOWN

    def _show_keys(self, note: RoverStationEvent, now: float) -> None:
        """Follow the keys of a note: its text is the key, and why it no longer counts behind a colon."""
        key = decode_text(note).partition(": ")[0]
        if note.kind == Kind.KEYS_DOWN:
            self._keys[key] = None
            self._demand_until = now + DEMAND_SHOWN
        elif note.kind == Kind.KEYS_UP:
            self._keys.pop(key, None)
            if not note.throttle and not note.steering:
                self._keys.clear()
