"""One vehicle that a verb hears: a contact of an OperatorCore, with the jobs and proofs of the verb."""

from __future__ import annotations

from typing import Protocol

from dialects import messages as m
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.station.operator_core import OperatorCore
from groundstation.vehicles.fleet import Contact
from groundstation.vehicles.probes.dialect_probe import FOREIGN_AUTOPILOTS, DialectProbe
from groundstation.vehicles.requests.requests import RequestBook
from groundstation.vehicles.services import VehicleServices
from groundstation.vehicles.state.message_log import MessageLog
from groundstation.vehicles.state.vehicle_details import VehicleDetails
from groundstation.verbs.session.operator import VerbOperator
from groundstation.verbs.session.outbox import VerbOutbox
from link.core import Received
from link.services.command.client import CommandClient, CommandOutcome


class Job(Protocol):
    """A request of several steps, or one that is repeated until the vehicle has done it; it ends in the book."""

    number: int

    def tick(self, client: CommandClient, book: RequestBook, now: float) -> None:
        """Handle the entries that are due."""

    def handle_outcome(self, outcome: CommandOutcome, client: CommandClient, book: RequestBook, now: float) -> None:
        """Note how a command ended."""


class VehicleContact:
    """A vehicle of `station`. State and services are those of the contact; jobs and proofs are those of the verb."""

    def __init__(self, station: OperatorCore, contact: Contact, outbox: VerbOutbox, now: float) -> None:
        self._station = station
        self.ids, self.session = station.parts.ids, station.parts.proofs.session
        self.found_at = now
        """When it was heard first."""
        self.contact = contact
        self.state = contact.state
        self.services: VehicleServices = station.services.services_of(contact)
        """Its services, which screens of a station use, too."""
        self.operator = VerbOperator(contact, station.parts.proofs, outbox.demands)
        self.client = CommandClient(*self.ids, outbox.commands)
        """For jobs."""
        self.texts = MessageLog()
        """What it has said."""
        self.refusal = ""
        """Why a message to it was not sent: the role of this program does not allow it."""
        self.unproven = ""
        """Why the session was not proven to it, likewise."""
        self._jobs: list[Job] = []

    @property
    def details(self) -> VehicleDetails:
        """What else it reports."""
        return self.contact.details

    @property
    def in_control(self) -> bool:
        """This program is in control, as the vehicle reports it."""
        return bool(self.state.driver) and self.state.control.is_program(
            self.ids, self.session, accepted=self._is_claimed
        )

    @property
    def other_driver(self) -> int | None:
        """System id of another program in control; None if there is none, or the vehicle does not tell."""
        return self.state.driver if self.state.driver and not self.in_control else None

    @property
    def follows(self) -> bool:
        """The driver is a program with our ids that has not been silent for long enough yet to be succeeded."""
        return self.state.driver == self.ids[0] and not self.in_control and not self.state.control.silent

    @property
    def settled(self) -> bool:
        """Whether commands may follow: the session is proven, or the vehicle knows no sessions."""
        foreign = self.contact.dialect_probe.foreign or self.state.autopilot in FOREIGN_AUTOPILOTS
        return foreign or self.operator.proven

    @property
    def driven(self) -> WatchdogTarget:
        """What the watchdog must know."""
        return WatchdogTarget.of(self.state, self.session, verified=self.contact.verified)

    def begin(self, now: float) -> None:
        """Begin to take part: have the vehicle asked for its dialect anew, then prove the session."""
        if not self.operator.takes_part:
            self.contact.dialect_probe = DialectProbe()
        self.operator.begin(now)

    def start(self, job: Job, now: float) -> None:
        """Begin a job. It goes on when another component of the system turns out to be the autopilot."""
        self._jobs.append(job)
        self.services.lasting.add(job.number)
        job.tick(self.client, self.services.book, now)

    @property
    def _is_claimed(self) -> bool:
        """Whether it has accepted arming or a request for control from this program, and has not disarmed since."""
        return self._station.parts.commander.is_claimed(self.state.system)

    def claim(self, now: float) -> None:
        """Note that the vehicle has accepted arming."""
        self._station.claim(self.contact, now)

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of the vehicle, which its state and its services have already."""
        if isinstance(received.message, m.StatusText):
            self.texts.handle_statustext(received.message, received.system, now, received.component)
        self.client.receive(received, now)
        self._advance(now)

    def handle_refused(self, message: m.Message, why: str) -> None:
        """Note that a message to it was not sent. Stops need no session, so that without one a verb goes on."""
        if isinstance(message, m.RoverOperatorPresence):
            self.unproven = why
        else:
            self.refusal = why

    def tick(self, now: float) -> None:
        """Repeat what is overdue."""
        self.texts.expire(now)
        self.client.tick(now)
        self._advance(now)
        if self.operator.takes_part and not self.settled:
            self._station.find_dialect(self.contact, now)
        self.operator.tick(now)

    def _advance(self, now: float) -> None:
        book = self.services.book
        for outcome in self.client.outcomes():
            for job in self._jobs:
                job.handle_outcome(outcome, self.client, book, now)
        for job in self._jobs:
            job.tick(self.client, book, now)
        running = {report.number for report in book.running}
        self._jobs = [job for job in self._jobs if job.number in running]
