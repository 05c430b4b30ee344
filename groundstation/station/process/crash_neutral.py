"""Sends neutral to every driven vehicle after an unhandled exception in the station.

A station that exits normally sends its own final neutrals (groundstation/vehicles/demand/demand_stream.py). After an
exception nothing of the station can be trusted, and ArduPilot would drive on for 3 s with the last demand it got.
"""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from dialects.axes import build_neutral
from dialects.enums import Severity
from dialects.kinds import find_kind
from dialects.messages import Heartbeat, ManualControl, Message
from groundstation.snapshot import LogLine, OperatorView, Snapshot
from groundstation.station.driving.driven import DEMAND_MEMORY
from groundstation.station.station import Station
from groundstation.vehicles.demand.demand_stream import DRIVING_PERIOD, FINAL_NEUTRALS
from groundstation.vehicles.state.message_log import MAX_LENGTH
from groundstation.vehicles.state.vehicle_heartbeat import is_vehicle
from link.core import LinkReport, Outgoing, Received


class CrashNeutral:
    """A core around the station: passes everything on until `activate`; from then on only it sends messages."""

    def __init__(self, station: Station) -> None:
        self._station = station
        self._kinds: dict[int, tuple[int, int]] = {}
        """MAV_AUTOPILOT and MAV_TYPE of the vehicles that keys drive. Others get no neutral."""
        self._driven: dict[int, float] = {}
        """System id -> when the vehicle last got a demand from us."""
        self._active = False
        self._left = 0
        self._due = 0.0
        self._outbox: list[Outgoing] = []

    def activate(self, now: float) -> None:
        """Take over from the station: send the final neutrals, and do not call the station any more."""
        self._active = True
        recent = (system for system, at in self._driven.items() if now - at <= DEMAND_MEMORY)
        self._driven = {system: self._driven[system] for system in recent if system in self._kinds}
        self._left, self._due = FINAL_NEUTRALS if self._driven else 0, now
        self.tick(now)

    @property
    def finished(self) -> bool:
        """All final neutrals are sent, by the station or in its place."""
        return not (self._left or self._outbox) if self._active else self._station.finished

    @property
    def rest_period(self) -> float | None:
        """That of the station while it runs."""
        return None if self._active else self._station.rest_period

    @property
    def interesting_systems(self) -> frozenset[int] | None:
        """The vehicles that the station looks at; after an exception it is not asked."""
        return frozenset(self._driven) if self._active else self._station.interesting_systems

    # ---- Core ----

    def receive(self, received: Received, now: float) -> None:
        """Record the vehicle's autopilot, which defines its axes, and pass the message on."""
        if isinstance(received.message, Heartbeat) and is_vehicle(received.message):
            self._note_kind(received.system, received.message)
        if not self._active:
            self._station.receive(received, now)

    def tick(self, now: float) -> None:
        """Queue one neutral demand for each driven vehicle when it is due."""
        if not self._active:
            self._station.tick(now)
        elif self._left and now >= self._due:
            self._left -= 1
            self._due = now + DRIVING_PERIOD
            self._outbox += [Outgoing(self._neutral(system)) for system in self._driven]

    @property
    def repeats(self) -> bool:
        """Whether the newest message has only repeated to the station what another path had brought."""
        return not self._active and self._station.repeats

    @property
    def due_at(self) -> float | None:
        """When the station has something to do before the next tick."""
        return None if self._active else self._station.due_at

    def act(self, now: float) -> None:
        """Let the station do it."""
        if not self._active:
            self._station.act(now)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Pass the link reports on."""
        if not self._active:
            self._station.observe(reports, now)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now and clear the queue."""
        if not self._active:
            return self._station.messages_to_send()
        outbox, self._outbox = self._outbox, []
        return outbox

    def handle_sent(self, message: Message, sequence: int, now: float) -> None:
        """Record which vehicle is driven, and pass the call on."""
        if isinstance(message, ManualControl):
            self._driven[message.target] = now
        if not self._active:
            self._station.handle_sent(message, sequence, now)

    def handle_refused(self, message: Message, why: str, now: float) -> None:
        """Pass on why a message was not sent."""
        if not self._active:
            self._station.handle_refused(message, why, now)

    def may_send(self, message: Message, now: float) -> bool:
        """Return whether a message may still be sent; the station withdraws old demands."""
        return self._active or self._station.may_send(message, now)

    def _note_kind(self, system: int, beat: Heartbeat) -> None:
        if find_kind(beat.autopilot, beat.type).is_driven:
            self._kinds[system] = (beat.autopilot, beat.type)
        else:
            self._kinds.pop(system, None)

    def _neutral(self, system: int) -> ManualControl:
        return build_neutral(system, *self._kinds[system])


def crash_snapshot(last: Snapshot, what: str, wall: float) -> Snapshot:
    """Return the last snapshot with the reason why no other follows."""
    line = LogLine(time=wall, severity=Severity.CRITICAL, label="station", text=what[:MAX_LENGTH])
    stopped = OperatorView(
        style=last.operator.style,
        reports_releases=last.operator.reports_releases,
        gate_reason="station crashed",
    )
    return msgspec.structs.replace(last, number=last.number + 1, operator=stopped, texts=(*last.texts, line))
