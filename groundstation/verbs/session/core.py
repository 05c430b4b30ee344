"""The core of a verb: the vehicles of an OperatorCore, and what the verb sends to them. Time is an argument."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence

from dialects import messages as m
from dialects.kinds import AUTOPILOT_COMPONENT
from groundstation.station.core_parts import CoreParts
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.station.driving.stall import Standstill
from groundstation.station.links.heartbeat_sender import HeartbeatSender
from groundstation.station.operator_core import TICK_PERIOD, OperatorCore
from groundstation.vehicles.demand.drive_gate import drive_refusal
from groundstation.vehicles.state.vehicle_heartbeat import is_vehicle
from groundstation.verbs.common.arguments import is_chosen
from groundstation.verbs.session.contact import VehicleContact
from link.core import LinkReport, Outgoing, Received

WATCHER = 25
"""MAV_COMP_ID_USER1: of verbs that only look. With the ids of a silent driver, as of the verb before, any command would
count as its successor, and our vehicle would leave an autonomous mode (docs/safety.md, "Who the driver is")."""

ALONE_AFTER = 1.3
"""s for which the links are heard before a vehicle counts as the only one, and a script that claims to be an autopilot
as the autopilot: a heartbeat interval and a delay."""

SIGNS = "it signs its frames with a key that is not here, and may obey only that: `mavhelm sign` has the keys"

Tap = Callable[[Received, float], None]
"""Takes each message that arrives, and the time."""


class VerbCore:
    """A verb on `station`: that of its own process (OwnCore), or of one that runs (StationCore).

    It talks to `wanted`, or to the first vehicle that is heard.
    """

    def __init__(self, station: OperatorCore, wanted: int | str | None) -> None:
        self.station = station
        self.contacts: dict[int, VehicleContact] = {}
        """All vehicles heard, by system id."""
        self.chosen: VehicleContact | None = None
        self.reports: tuple[LinkReport, ...] = ()
        """The newest of each link."""
        self.heard: dict[tuple[int, type[m.Message]], float] = {}
        """System id of a vehicle and kind -> when the newest such message arrived that its contact knows; also the
        first ones, before any tap."""
        self.frames_sent = 0
        """On links of this program; each address counts."""
        self.taps: list[Tap] = []
        """Called with each message that arrives."""
        self.has_heard_all = False
        """The links were heard for longer than this verb runs, by the station that it goes through."""
        self.standstill = Standstill()
        """Of this process, while a watchdog stands by."""
        self.outbox: list[m.Message] = []
        """Messages of a verb, to all or to their target."""
        self.ids = station.parts.ids
        """Our system and component id."""
        self._wanted = wanted
        self._heartbeat = HeartbeatSender(0.0)
        self._waiters: list[tuple[Callable[[], bool], asyncio.Future[None]]] = []

    def receive(self, received: Received, now: float) -> None:
        """Handle one message, which the station has handled; the HEARTBEAT of a vehicle begins the conversation."""
        if type(received.message) is m.SetupSigning:
            received = received._replace(message=m.hide_key(received.message))
        if is_vehicle(received.message):
            self._heartbeat.greet(received.peer, now)
            self.add_vehicles(now)
        contact = self.contacts.get(received.system)
        if contact is not None:
            contact.receive(received, now)
            self.heard[received.system, type(received.message)] = now
        for tap in self.taps:
            tap(received, now)
        if self.chosen is None and not self.has_heard_all:
            self._choose(now)
        self._check_waiters()

    def add_vehicles(self, now: float) -> None:
        """Take the vehicles of the station that are heard, and leave out those for which it has no place."""
        fleet = self.station.fleet
        for contact in fleet:
            known = self.contacts.get(contact.state.system)
            if (known is None or known.contact is not contact) and contact.state.monitor.is_alive(now):
                self.contacts[contact.state.system] = VehicleContact(self.station, contact, now)
        self.contacts = {system: each for system, each in self.contacts.items() if fleet.get(system) is each.contact}

    def handle_refused(self, message: m.Message, why: str, now: float) -> None:
        """Note that a message was not sent, because the role of this program does not allow it."""
        contact = self.contacts.get(m.target_system(message))
        if contact is not None:
            contact.handle_refused(message, why)
            self._check_waiters()

    def tick(self, now: float) -> None:
        """Send heartbeats, repeat what is overdue."""
        demanding = self.chosen is not None and self.chosen.operator.demanding
        self.outbox += [each.message for each in self._heartbeat.tick(now, driving=demanding)]
        if self.chosen is None:
            self._choose(now)
        for contact in self.contacts.values():
            contact.tick(now)
        self._check_waiters()

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Keep the reports of the links."""
        self.reports = tuple(reports)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them."""
        outbox, self.outbox = self.outbox, []
        found = [Outgoing(message) for message in outbox]
        return found + [each for contact in self.contacts.values() for each in contact.messages_to_send()]

    def explain_silence(self, system: int) -> str:
        """Return why a vehicle that is heard may answer nothing: it signs with a key that is not here; else ""."""
        if not any(system in each.signing for each in self.reports):
            return ""
        if any(system in each.verified for each in self.reports):
            return ""
        return f"; {SIGNS}"

    def driven(self) -> tuple[WatchdogTarget, ...]:
        """Return what the watchdog must know. It sends no neutral to a kind that is not driven: it may fall by it."""
        chosen = self.chosen
        return (chosen.driven,) if chosen is not None and chosen.state.model.is_driven else ()

    def add_waiter(self, condition: Callable[[], bool]) -> asyncio.Future[None]:
        """Return a future that is done once `condition` holds, checked after each message and tick."""
        found: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiters.append((condition, found))
        return found

    def _check_waiters(self) -> None:
        for condition, found in self._waiters:
            if not found.done() and condition():
                found.set_result(None)
        self._waiters = [each for each in self._waiters if not each[1].done()]

    def _choose(self, now: float) -> None:
        """Choose the vehicle. One that is not heard as an autopilot yet may be a script on board of it."""
        for system, contact in self.contacts.items():
            state, waited = contact.state, now - contact.found_at
            if (state.component == AUTOPILOT_COMPONENT or waited >= ALONE_AFTER or self.has_heard_all) and is_chosen(
                self._wanted, system, state.fleet_name
            ):
                self.chosen = contact
                return


class OwnCore(VerbCore):
    """A core (link/core.py) for the links of this process, with an OperatorCore that no screen uses.

    `ids` are our system and component id, `session` is the number of our session.
    """

    def __init__(
        self,
        ids: tuple[int, int],
        wanted: int | str | None,
        session: int,
        endpoints: Sequence[str] = (),
        now: float = 0.0,
    ) -> None:
        parts = CoreParts(endpoints, system=ids[0], component=ids[1], session=session, now=now)
        super().__init__(OperatorCore(parts, serves=True), wanted)
        self.station.fleet.is_meant = self._is_meant
        self._station_due = now

    def receive(self, received: Received, now: float) -> None:
        """Handle one message."""
        self.station.receive(received, now)
        self.station.services.collect(now)
        super().receive(received, now)

    def handle_sent(self, message: m.Message, sequence: int, now: float) -> None:
        """Count a frame that has left on a link of this program."""
        self.frames_sent += 1

    def tick(self, now: float) -> None:
        """Repeat what is overdue; the station needs all ticks only while something is under way there."""
        if self.station.rest_period is None or now >= self._station_due:
            self._station_due = now + TICK_PERIOD
            self.station.tick(now)
        super().tick(now)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Keep the reports of the links."""
        self.station.observe(reports, now)
        super().observe(reports, now)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them; the proof goes before the command that needs it."""
        return super().messages_to_send() + self.station.messages_to_send()

    def may_send(self, message: m.Message, now: float) -> bool:
        """Return False for what would move a vehicle of a kind that is not driven; the verb is told why."""
        why = drive_refusal(message, (contact.state for contact in self.contacts.values()))
        if why is not None:
            self.handle_refused(message, why, now)
        return why is None

    def _choose(self, now: float) -> None:
        """Choose the vehicle, and select it, so that no other one gets its place."""
        super()._choose(now)
        if self.chosen is not None:
            self.station.fleet.select(self.chosen.state.system, now)

    def _is_meant(self, received: Received) -> bool:
        return self._wanted is not None and is_chosen(self._wanted, received.system, received.peer.name)
