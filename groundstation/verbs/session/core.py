"""The core of a verb: the vehicles of an OperatorCore, and what the verb sends to them. Time is an argument."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence

from dialects import codec
from dialects import messages as m
from dialects.kinds import AUTOPILOT_COMPONENT
from groundstation.station.core_parts import CoreParts
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.station.driving.stall import Standstill
from groundstation.station.links.heartbeat_sender import HeartbeatSender
from groundstation.station.operator_core import OperatorCore
from groundstation.station.verbs.running_verbs import Purpose, VerbMessage
from groundstation.vehicles.state.vehicle_heartbeat import is_vehicle
from groundstation.verbs.common.arguments import is_chosen
from groundstation.verbs.session.contact import VehicleContact
from groundstation.verbs.session.outbox import VerbOutbox
from link.core import LinkReport, Outgoing, Received
from link.protocol.log_tap import LogTap

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
    """A verb in `station`, where a StationSeat joins it: one that runs, or (`own`) one for this verb alone.

    It talks to `wanted`, or to the first vehicle that is heard.
    """

    def __init__(self, station: OperatorCore, wanted: int | str | None, *, own: bool = False) -> None:
        self.station = station
        self.contacts: dict[int, VehicleContact] = {}
        """All vehicles heard, by system id."""
        self.chosen: VehicleContact | None = None
        self.reports: tuple[LinkReport, ...] = ()
        """The newest of each link."""
        self.heard: dict[tuple[int, type[m.Message]], float] = {}
        """System id of a vehicle and kind -> when the newest such message arrived that its contact knows; also the
        first ones, before any tap."""
        self.taps: list[Tap] = []
        """Called with each message that arrives."""
        self.has_heard_all = not own
        """The links were heard for longer than this verb runs, by a station that runs."""
        self.standstill = Standstill()
        """Of this process, while a watchdog stands by."""
        self.outbox = VerbOutbox()
        self.ids = station.parts.ids
        """Our system and component id."""
        self._wanted = wanted
        self._heartbeat = HeartbeatSender(0.0)
        self._waiters: list[tuple[Callable[[], bool], asyncio.Future[None]]] = []
        if own:
            station.fleet.is_meant = self._is_meant

    @classmethod
    def alone(
        cls,
        ids: tuple[int, int],
        wanted: int | str | None,
        session: int,
        endpoints: Sequence[str] = (),
        now: float = 0.0,
    ) -> VerbCore:
        """Return one with an OperatorCore for itself.

        `ids` are our system and component id, `session` is the number of our session.
        """
        parts = CoreParts(endpoints, system=ids[0], component=ids[1], session=session, now=now)
        return cls(OperatorCore(parts), wanted, own=True)

    @property
    def frames_sent(self) -> int:
        """Frames sent on the links, as of their newest reports; each address counts."""
        return sum(report.frames_sent for report in self.reports)

    def receive(self, received: Received, now: float) -> None:
        """Handle one message, which the station has handled; the HEARTBEAT of a vehicle begins the conversation."""
        self.station.services.collect(now)  # what this message has ended
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
                self.contacts[contact.state.system] = VehicleContact(self.station, contact, self.outbox, now)
        self.contacts = {system: each for system, each in self.contacts.items() if fleet.get(system) is each.contact}

    def handle_refused(self, message: m.Message, why: str, now: float) -> None:
        """Note that a message was not sent, because the role of this program does not allow it."""
        contact = self.contacts.get(m.target_system(message))
        if contact is not None:
            contact.handle_refused(message, why)
            self._check_waiters()

    def tick(self, now: float) -> None:
        """Send heartbeats, repeat what is overdue."""
        if self.has_heard_all:  # else a watchdog measures it
            self.standstill.record_report(now)
        self.add_vehicles(now)
        demanding = self.chosen is not None and self.chosen.operator.demanding
        beats = self._heartbeat.tick(now, driving=demanding)
        self.outbox.demands += [VerbMessage(each.message, Purpose.PRESENCE) for each in beats]
        if self.chosen is None:
            self._choose(now)
        for contact in self.contacts.values():
            contact.tick(now)
        self._check_waiters()

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Take the vehicles that the station knows, and the reports of its links."""
        self.add_vehicles(now)
        self.reports = tuple(reports)

    def demand(self, message: m.Message, *, moves: bool) -> None:
        """Send a demand that moves, or the neutral one that ends it."""
        self.outbox.demands.append(VerbMessage(message, Purpose.MOTION if moves else Purpose.NEUTRAL))

    def send(self, *messages: m.Message) -> None:
        """Send messages that are no demands."""
        self.outbox.commands += map(Outgoing, messages)

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

    def record(self, log_tap: LogTap) -> None:
        """Have all that the station hears recorded, as frames without signatures. To be called before it joins."""

        def take(received: Received, now: float) -> None:
            number, place = type(received.message).id, (received.system, received.component)
            raw = codec.frame(number, codec.encode_payload(received.message), received.sequence, *place)
            log_tap.record_received([(number, *place, received.sequence, raw)], received.peer.link, now)

        self.taps.append(take)

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
                if not self.has_heard_all:  # no other vehicle gets its place
                    self.station.fleet.select(system, now)
                return

    def _is_meant(self, received: Received) -> bool:
        return self._wanted is not None and is_chosen(self._wanted, received.system, received.peer.name)
