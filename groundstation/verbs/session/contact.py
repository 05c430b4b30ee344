"""One vehicle that a verb hears: its state, its services, and this program as its operator. Time is an argument."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

from dialects import messages as m
from dialects.enums import Command
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.vehicles.requests.requests import RequestBook
from groundstation.vehicles.services import VehicleServices
from groundstation.vehicles.state.message_log import MessageLog, VehicleText
from groundstation.vehicles.state.vehicle_details import VehicleDetails
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.verbs.session.operator import VerbOperator
from link.core import Outgoing, Received
from link.services.command.client import CommandClient, CommandOutcome


class Job(Protocol):
    """A request of several steps, or one that is repeated until the vehicle has done it; it ends in the book."""

    number: int

    def tick(self, client: CommandClient, book: RequestBook, now: float) -> None:
        """Handle the entries that are due."""

    def handle_outcome(self, outcome: CommandOutcome, client: CommandClient, book: RequestBook, now: float) -> None:
        """Note how a command ended."""


class VehicleContact:
    """The vehicle with the ids `target`. `ids` are ours, `session` is the random number of this run."""

    def __init__(self, ids: tuple[int, int], session: int, target: tuple[int, int], now: float) -> None:
        self.ids = ids
        self.found_at = now
        """When it was heard first."""
        self.session = session
        self.state = VehicleState(*target)
        self.details = VehicleDetails(target[1])
        self.services = VehicleServices(*ids, target)
        self.operator = VerbOperator(self.state, ids, session)
        self.client = CommandClient(*ids)
        """For jobs and for the operator's queries."""
        self.verified = False
        """It has signed with a key of ours."""
        self.texts = MessageLog()
        """What it has said."""
        self.refusal = ""
        """Why a message to it was not sent: the role of this program does not allow it."""
        self.unproven = ""
        """Why the session was not proven to it, likewise."""
        self._jobs: list[Job] = []

    @property
    def busy(self) -> bool:
        """A request to it is under way."""
        return bool(self._jobs or self.services.book.running)

    @property
    def in_control(self) -> bool:
        """This program is in control, as the vehicle reports it."""
        return bool(self.state.driver) and self.state.control.is_program(self.ids, self.session, accepted=False)

    @property
    def other_driver(self) -> int | None:
        """System id of another program in control; None if there is none, or the vehicle does not tell."""
        return self.state.driver if self.state.driver and not self.in_control else None

    @property
    def follows(self) -> bool:
        """The driver is a program with our ids that has not been silent for long enough yet to be succeeded."""
        return self.state.driver == self.ids[0] and not self.in_control and not self.state.control.silent

    @property
    def driven(self) -> WatchdogTarget:
        """What the watchdog must know."""
        return WatchdogTarget.of(self.state, self.session, verified=self.verified)

    def start(self, job: Job, now: float) -> None:
        """Begin a job."""
        self._jobs.append(job)
        job.tick(self.client, self.services.book, now)

    def change_component(self, component: int, now: float) -> None:
        """Talk to another component of the system: the autopilot was heard after it. Jobs go on."""
        self.state.change_component(component)
        self.details = VehicleDetails(component)
        self.services.change_component(component, now, keep={job.number for job in self._jobs})

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of the vehicle."""
        self.verified |= received.signed
        self.state.receive(received, now)
        self.details.receive(received, now)
        self.services.note_state(self.state)
        if isinstance(received.message, m.StatusText):
            self._handle_texts(
                self.texts.handle_statustext(received.message, received.system, now, received.component), now
            )
        self.services.receive(received, now)
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
        self._handle_texts(self.texts.expire(now), now)
        self.client.tick(now)
        self._advance(now)
        self.operator.tick(self.client, now, may_query=not self.services.commands.is_waiting(Command.REQUEST_MESSAGE))
        self.services.tick(now, may_query=not self.client.is_waiting(Command.REQUEST_MESSAGE, self.state.system))

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them; the proof goes before the command that needs it."""
        operator = self.operator.messages_to_send()
        return operator + self.client.messages_to_send() + self.services.messages_to_send()

    def _advance(self, now: float) -> None:
        book = self.services.book
        for outcome in self.client.outcomes():
            self.operator.handle_outcome(outcome, now)
            for job in self._jobs:
                job.handle_outcome(outcome, self.client, book, now)
        for job in self._jobs:
            job.tick(self.client, book, now)
        running = {report.number for report in book.running}
        self._jobs = [job for job in self._jobs if job.number in running]

    def _handle_texts(self, texts: Iterable[VehicleText], now: float) -> None:
        for each in texts:
            self.state.handle_text(each.text)
            self.services.handle_text(each.text, each.severity, now)
