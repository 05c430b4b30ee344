"""All vehicles that were heard, and which one the operator looks at. It sees them come, go silent and come back."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from dialects.enums import Autopilot, Severity, VehicleType
from dialects.messages import Heartbeat, Message
from groundstation.vehicles.ardupilot_checks import ArduPilotChecks
from groundstation.vehicles.demand_stream import DemandStream
from groundstation.vehicles.dialect_probe import DialectProbe
from groundstation.vehicles.message_log import MessageLog
from groundstation.vehicles.stream_requests import StreamRequests
from groundstation.vehicles.vehicle_state import VehicleState
from link.core import Received

MAX_VEHICLES = 16
"""More would not fit on the screen; a flood of invented ids must not grow a table."""


@dataclass(slots=True)
class Contact:
    """A vehicle and what the station keeps beside its picture."""

    state: VehicleState
    stream_requests: StreamRequests
    link: int
    """Index of the link on which it was heard last."""
    settings_check: ArduPilotChecks | None = None
    demand_stream: DemandStream = field(default_factory=DemandStream)
    lost_at: float | None = None
    dialect_probe: DialectProbe = field(default_factory=DialectProbe)


class Fleet:
    """The contacts by system id. `system` is ours."""

    def __init__(self, log: MessageLog, system: int) -> None:
        self.selected: Contact | None = None
        self._log = log
        self._system = system
        self._contacts: dict[int, Contact] = {}

    def __iter__(self) -> Iterator[Contact]:
        return iter(self._contacts.values())

    @property
    def system_ids(self) -> tuple[int, ...]:
        """System ids of all of them, in rising order."""
        return tuple(sorted(self._contacts))

    def get(self, system: int) -> Contact | None:
        """The contact with this system id."""
        return self._contacts.get(system)

    def select(self, system: int, now: float) -> None:
        """Look at this one from now on, where it is known."""
        contact = self._contacts.get(system)
        if contact is None:
            self._log.add(now, "station", f"there is no vehicle {system}", Severity.WARNING)
        elif contact is not self.selected:
            self.selected = contact
            self._log.add(now, "station", f"{contact.state.name} selected", Severity.NOTICE)

    def select_next(self, now: float) -> None:
        """Look at the one with the next higher system id, or again at the first."""
        systems = sorted(self._contacts)
        if len(systems) < 2 or self.selected is None:
            self._log.add(now, "station", "there is no other vehicle", Severity.NOTICE)
            return
        at = systems.index(self.selected.state.system)
        self.select(systems[(at + 1) % len(systems)], now)

    def get_or_add(self, received: Received, now: float) -> Contact | None:
        """The contact that a message belongs to; a vehicle's HEARTBEAT makes a new one."""
        contact = self._contacts.get(received.system)
        if contact is not None:
            contact.link = received.peer.link
        if contact is not None or not is_vehicle(received.message) or len(self._contacts) >= MAX_VEHICLES:
            return contact
        state = VehicleState(received.system, received.component)
        state.receive(received, now)
        target = (state.system, state.component)
        contact = Contact(state, StreamRequests(target, now), received.peer.link)
        self._contacts[received.system] = contact
        if ArduPilotChecks.applies_to(state.autopilot):
            contact.settings_check = ArduPilotChecks(self._system, target)
        self.selected = self.selected or contact
        self._log.add(now, "station", f"{state.name} found", Severity.NOTICE)
        return contact

    def update(self, now: float) -> None:
        """Notice who went silent and who came back."""
        for contact in self._contacts.values():
            monitor, name = contact.state.monitor, contact.state.name
            if contact.lost_at is None and not monitor.is_alive(now):
                contact.lost_at = now - monitor.silence(now)
                self._log.add(now, "station", f"{name} lost: silent for {monitor.timeout:g} s", Severity.CRITICAL)
            elif contact.lost_at is not None and monitor.is_alive(now):
                self._log.add(now, "station", f"{name} is back after {now - contact.lost_at:.1f} s", Severity.NOTICE)
                contact.lost_at = None
                contact.stream_requests.restart(now)
                contact.dialect_probe = DialectProbe()


def is_vehicle(message: Message) -> bool:
    """Is this the HEARTBEAT of something that drives, and not of a ground station, a camera or a radio?"""
    return isinstance(message, Heartbeat) and message.type != VehicleType.GCS and message.autopilot != Autopilot.INVALID
