"""The core and the session of a verb that runs in the process of a station, over the vehicles of its OperatorCore."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from itertools import count

from dialects import messages as m
from dialects.enums import Command
from groundstation.station.operator_core import OperatorCore
from groundstation.station.relay.verb_relay import Verb
from groundstation.station_socket.verb_run import STILL_WITHIN
from groundstation.vehicles.fleet import Contact
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.vehicles.services import VehicleServices
from groundstation.vehicles.state.message_log import MessageLog
from groundstation.vehicles.state.vehicle_details import VehicleDetails
from groundstation.verbs.session.contact import VehicleContact
from groundstation.verbs.session.core import VerbCore
from groundstation.verbs.session.operator import VerbOperator
from groundstation.verbs.session.session import Interrupted, RequestStart, VerbSession
from link.core import LinkReport, Outgoing, Received
from link.services.command.client import CommandClient

NUMBERS = count(1 << 40)
"""Numbers of requests, far from those that screens take."""


class StationContact(VehicleContact):
    """A vehicle of the station. State and services are the station's; jobs and proofs are those of this verb."""

    def __init__(self, station: OperatorCore, contact: Contact, now: float) -> None:
        self.ids, self.session = station.parts.ids, station.operator.session
        self.found_at = now
        self.contact = contact
        self.state = contact.state
        self.operator = VerbOperator(contact.state, self.ids, self.session)
        self.client = CommandClient(*self.ids)
        self.texts = MessageLog()
        self.refusal = self.unproven = ""
        self._station = station
        self._jobs = []

    @property
    def details(self) -> VehicleDetails:  # type: ignore[override]
        """What else it reports."""
        return self.contact.details

    @property
    def services(self) -> VehicleServices:  # type: ignore[override]
        """Its services, which screens use, too."""
        return self._station.services.services_of(self.contact)

    @property
    def verified(self) -> bool:  # type: ignore[override]
        """It has signed with a key of ours."""
        return self.contact.verified

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of the vehicle, which its state and its services have already."""
        if isinstance(received.message, m.StatusText):
            self.texts.handle_statustext(received.message, received.system, now, received.component)
        self.client.receive(received, now)
        self._advance(now)

    def tick(self, now: float) -> None:
        """Repeat what is overdue."""
        self.texts.expire(now)
        self.client.tick(now)
        self._advance(now)
        asks = self.services.commands.is_waiting(Command.REQUEST_MESSAGE)
        self.operator.tick(self.client, now, may_query=not asks)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them; those of the services are the station's."""
        return self.operator.messages_to_send() + self.client.messages_to_send()


class StationCore(VerbCore):
    """The core of a verb in a station, which has heard all vehicles and owns the links. `wanted` as for VerbCore.

    A mistake of the verb must not end the station: it ends the verb (`broken`).
    """

    def __init__(
        self,
        station: OperatorCore,
        wanted: int | str | None,
        name: str,
        flush: Callable[[], None],
        *,
        takes_part: bool = False,
        follows: bool = False,
        silence: Callable[[float], float] = lambda now: 0.0,
    ) -> None:
        """`flush` sends what the station has queued; `silence`: for how many s the shell of the verb was silent."""
        super().__init__(station.parts.ids, wanted, station.operator.session)
        self.has_heard_all = True
        self.broken: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        """Has what ends the verb: a mistake in it, or a demand that is refused."""
        self.station, self._flush, self._silence = station, flush, silence
        self._verb = Verb(
            name, takes_part, self._deliver, self._report, lambda line: None, follows=follows, runs_here=True,
            tell_refusal=self._take_refusal, tick=self._run_tick,
        )  # fmt: skip

    def join(self) -> None:
        """Begin: take what the station knows."""
        now = self._now
        self._add_all(now)
        self.station.relay.join(self._verb, now)
        self._run_tick(now)
        self._flush()

    def leave(self) -> None:
        """End: send what is left."""
        self.flush()
        self.station.relay.leave(self._verb, self._now)
        self._flush()

    def flush(self) -> None:
        """Send the messages of the verb now."""
        self._pass_on(self._now)
        self._flush()

    @property
    def _now(self) -> float:
        return asyncio.get_running_loop().time()

    def _add(self, received: Received, now: float) -> None:
        self._add_all(now)

    def _add_all(self, now: float) -> None:
        """Add the vehicles of the station that are heard."""
        for contact in self.station.fleet:
            known = self.contacts.get(contact.state.system)
            is_same = isinstance(known, StationContact) and known.contact is contact
            if not is_same and contact.state.monitor.is_alive(now):
                self.contacts[contact.state.system] = StationContact(self.station, contact, now)

    def _deliver(self, batch: Sequence[Received]) -> None:
        now = self._now
        self._guard(lambda: self._receive_all(batch, now))
        self._pass_on(now)

    def _receive_all(self, batch: Sequence[Received], now: float) -> None:
        self.station.services.collect(now)  # what this message has ended
        for received in batch:
            self.receive(received, now)

    def _run_tick(self, now: float) -> None:
        """Tick, unless the shell stands still."""
        if self._silence(now) > STILL_WITHIN:
            return
        self.station.relay.hear(self._verb, now)
        self._guard(lambda: self._add_all(now))
        self._guard(lambda: self.tick(now))
        self._pass_on(now)

    def _report(self, reports: Sequence[LinkReport]) -> None:
        self.observe(reports, self._now)

    def _take_refusal(self, message: m.Message, why: str) -> None:
        self._guard(lambda: self.handle_refused(message, why, self._now))

    def _pass_on(self, now: float) -> None:
        """Give the messages of the verb to the station, which sends them; later if the shell stands still."""
        if self._silence(now) > STILL_WITHIN:
            return
        for outgoing in self.messages_to_send():
            self.station.relay.handle(self._verb, outgoing.message, now)

    def _guard(self, step: Callable[[], object]) -> None:
        try:
            step()
        except Exception as error:
            if not self.broken.done():
                self.broken.set_exception(error)


class StationVerbSession(VerbSession):
    """The session of a verb that runs in a station: its requests are the station's, and in its log."""

    core: StationCore

    async def request(self, start: RequestStart, interrupted: Interrupted | None = None) -> RequestReport:
        """Make a request and return how it ended; it is cancelled with the verb."""
        services, number, ended = self.core.station.services, next(NUMBERS), list[RequestReport]()

        def tell(report: RequestReport) -> None:
            self._progress(report)
            if report.state is not RequestState.RUNNING:
                ended.append(report)

        services.follow(number, tell)
        start(number, self.now)
        services.collect(self.now)
        self.flush()
        try:
            if not ended:
                await self.core.add_waiter(lambda: bool(ended) or bool(self._refusal))
        except asyncio.CancelledError:
            if interrupted is not None:
                interrupted(number)
            services.cancel(number, self.now)
            self.flush()
            raise
        self.need_sent()
        return ended[0]
