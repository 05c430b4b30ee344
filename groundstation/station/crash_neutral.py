"""The last words of a station that broke: neutral, several times, to each vehicle it drove. It trusts nothing of it.

A station that ends in order says its own neutrals (groundstation/vehicles/demand_stream.py). This is for an exception of ours: ArduPilot would drive
on for 3 s with the last demand it got.
"""

from __future__ import annotations

from collections.abc import Sequence

from dialects.axes import NEUTRAL, axis_map, build_manual_control
from dialects.enums import Autopilot
from dialects.messages import Heartbeat, ManualControl, Message
from groundstation.station.station import Station
from groundstation.vehicles.demand_stream import DRIVING_PERIOD, FINAL_NEUTRALS
from groundstation.vehicles.fleet import is_vehicle
from link.core import LinkReport, Outgoing, Received

LATCH = 3.0
"""s for which a vehicle may hold a demand (ArduPilot's RC_OVERRIDE_TIME): who got none for longer is left alone."""


class CrashNeutral:
    """A core around the station: hands everything on until `begin`; from then on it speaks alone."""

    def __init__(self, station: Station) -> None:
        self._station = station
        self._autopilots: dict[int, int] = {}
        self._driven: dict[int, float] = {}
        """System id -> when it last got a demand of ours."""
        self._begun = False
        self._left = 0
        self._due = 0.0
        self._outbox: list[Outgoing] = []

    def activate(self, now: float) -> None:
        """The station is not to be asked any more."""
        self._begun = True
        self._driven = {system: at for system, at in self._driven.items() if now - at <= LATCH}
        self._left, self._due = FINAL_NEUTRALS if self._driven else 0, now
        self.tick(now)

    @property
    def finished(self) -> bool:
        """Everything is said: by the station itself, or for it."""
        return not (self._left or self._outbox) if self._begun else self._station.finished

    # ---- Core ----

    def receive(self, received: Received, now: float) -> None:
        """Remember whose axes mean what, and hand it on."""
        if isinstance(received.message, Heartbeat) and is_vehicle(received.message):
            self._autopilots[received.system] = received.message.autopilot
        if not self._begun:
            self._station.receive(received, now)

    def tick(self, now: float) -> None:
        """One neutral a vehicle when it is due."""
        if not self._begun:
            self._station.tick(now)
        elif self._left and now >= self._due:
            self._left -= 1
            self._due = now + DRIVING_PERIOD
            self._outbox += [Outgoing(self._neutral(system)) for system in self._driven]

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Hand it on."""
        if not self._begun:
            self._station.observe(reports, now)

    def messages_to_send(self) -> list[Outgoing]:
        """What to send now; empties what it returns."""
        if not self._begun:
            return self._station.messages_to_send()
        outbox, self._outbox = self._outbox, []
        return outbox

    def handle_sent(self, message: Message, sequence: int, now: float) -> None:
        """Remember who is driven, and hand it on."""
        if isinstance(message, ManualControl):
            self._driven[message.target] = now
        if not self._begun:
            self._station.handle_sent(message, sequence, now)

    def _neutral(self, system: int) -> ManualControl:
        return build_manual_control(NEUTRAL, system, axis_map(self._autopilots.get(system, Autopilot.GENERIC)))
