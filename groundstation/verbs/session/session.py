"""A ground station without a screen for one verb: finds a vehicle and makes requests to it."""

from __future__ import annotations

import asyncio
import contextlib
import math
from collections.abc import Callable, Mapping
from itertools import count

from dialects import messages as m
from dialects.enums import Command
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.station.driving.operator import NEUTRAL_LEAD
from groundstation.station.operator_core import OperatorCore
from groundstation.station.verbs.running_verbs import VerbMessage
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.vehicles.services import VehicleServices
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.verbs.common.channel import CompanionChannel
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.files import Files
from groundstation.verbs.session.contact import VehicleContact
from groundstation.verbs.session.core import ALONE_AFTER, VerbCore
from groundstation.verbs.session.link_reasons import describe_silence, to_view

SETTLED_WITHIN = 3.0
"""s to find out the dialect and prove the session; the question alone is repeated for 2.1 s."""
PROOF_PERIOD = 0.01
"""s between looks whether a proof is due, before the first command."""
TOLD_WITHIN = 0.5
"""s for our vehicle to tell which program is in control, once it knows that we understand it."""
DRIVER_WITHIN = 2.5
"""s until our vehicle tells who is in control: it does once a second, and one may get lost."""
SUCCESSION_WITHIN = 2.0
"""s for the session of the verb before this one to count as silent, which takes 0.7 s (docs/safety.md)."""

NUMBERS = count(1 << 40)
"""Numbers of requests, far from those that screens of a station take."""

RequestStart = Callable[[int, float], None]
"""Starts a request, with its number and the time."""

Interrupted = Callable[[int], None]
"""Gets the number of a request when its verb is interrupted, while what has arrived is still there."""


class VerbSession:
    """What a verb does with its vehicle, or with another one if `contact` is given."""

    def __init__(
        self,
        core: VerbCore,
        flush: Callable[[], None],
        progress: Callable[[RequestReport], None],
        contact: VehicleContact | None = None,
    ) -> None:
        self.core = core
        self.flush = flush
        self._progress = progress
        self._contact = contact
        self.files = Files()
        """The files of whoever typed the verb."""
        self.companion = CompanionChannel()
        """Of a verb that has a companion in the process of the user."""
        self.where = ""
        """The endpoints, for texts."""
        self.program = ""
        """What a station calls the program whose verb this is."""
        self.silence: Callable[[float], float] = lambda now: 0.0
        """For how many s that program was silent; gets the time."""
        self.began = self.now
        """When the verb began."""
        self.afterwards = "; this program no longer sends heartbeats"
        """What becomes of this program when the verb has ended, for a vehicle that moves by itself."""
        self.goes_on = False
        """It goes on behind the verb, and so do the neutrals at the end of arming: the next verb need not wait."""
        self.observe: Callable[[], None] = lambda: None
        """Gets the newest reports of links of its own; those of a station come by themselves."""

    @property
    def station(self) -> OperatorCore:
        """The core that has the vehicles: of a station that runs, or of this process."""
        return self.core.station

    def speak(self) -> list[VerbMessage]:
        """Return the messages to send now, and remove them."""
        return self.core.outbox.pop()

    def driven(self) -> tuple[WatchdogTarget, ...]:
        """Return what the watchdog must know."""
        return self.core.driven()

    @property
    def now(self) -> float:
        """The time of the loop's clock, s."""
        return asyncio.get_running_loop().time()

    @property
    def known(self) -> bool:
        """This session is about one vehicle that was heard."""
        return self._contact is not None

    @property
    def sure_at(self) -> float:
        """From when on every sender of an id was heard that sends once a second.

        A station has heard them before, unless it has just been started.
        """
        return max(self.began, self.station.parts.started + ALONE_AFTER)

    def next_within(self, told_within: float = 0.0) -> float:
        """Return for how many s to wait for a further vehicle: on links of its own anew after each.

        A station tells within `told_within` of all that it has heard.
        """
        return max(told_within, self.sure_at - self.now) if self.core.has_heard_all else ALONE_AFTER

    @property
    def names(self) -> tuple[int, str]:
        """System id of the vehicle and its name in its fleet, once it was heard."""
        return self.vehicle.system, self.vehicle.fleet_name

    @property
    def contact(self) -> VehicleContact:
        """The vehicle, once it was heard."""
        contact = self._contact or self.core.chosen
        assert contact is not None
        return contact

    @property
    def services(self) -> VehicleServices:
        """The services of the vehicle, once it was heard."""
        return self.contact.services

    @property
    def vehicle(self) -> VehicleState:
        """The vehicle, once it was heard."""
        return self.contact.state

    async def find_vehicle(self, wait: float, wanted: int | str | None) -> None:
        """Wait for the HEARTBEAT of the vehicle. Raises VerbError after `wait` s."""
        if not await self.wait_for(lambda: self.core.chosen is not None, wait):
            which = "no vehicle" if wanted is None else f"no vehicle {wanted}"
            why = f", but {_names(self.core.contacts)}" if self.core.contacts else self.describe_links()
            raise VerbError(ExitCode.NO_VEHICLE, f"{which} on {self.where} within {wait:g} s{why}")

    async def need_only_vehicle(self, wanted: int | str | None) -> None:
        """Before the first change: there must be only one, or only one with that name. Raises VerbError.

        Then the session is proven again, because listening for others takes a while.
        """
        if wanted is None:
            await self.hear_all()
            if len(self.core.contacts) > 1:
                heard = _names(self.core.contacts)
                raise VerbError(ExitCode.USAGE, f"vehicles {heard} are here: choose one with --vehicle")
        elif isinstance(wanted, str):
            same = [system for system, each in sorted(self.core.contacts.items()) if each.state.fleet_name == wanted]
            if len(same) > 1:
                text = f"{wanted} are several vehicles: choose one with --vehicle {same[0]}"
                raise VerbError(ExitCode.USAGE, text)
        await self._prove_again()

    async def hear_all(self, seconds: float = ALONE_AFTER) -> None:
        """Wait until the links were heard for so long; a station has heard them before."""
        await asyncio.sleep(max(0.0, self.station.parts.started + seconds - self.now))

    async def prove_session(self) -> None:
        """Prove this session, so that the vehicle accepts commands that need control.

        A vehicle that says neither that it has our dialect nor that it has not is treated as one without.
        """
        contact = self.contact
        contact.begin(self.now)
        await self._settle()
        if contact.state.has_rover_dialect:
            await self.wait_for(lambda: contact.state.control.session is not None, DRIVER_WITHIN)
            await self.wait_for(lambda: not contact.follows, SUCCESSION_WITHIN)
            await self._prove_again()

    async def _settle(self) -> None:
        """Wait until the first proofs are sent, or the vehicle is known to have no sessions."""
        contact, until = self.contact, self.now + SETTLED_WITHIN
        while not (contact.settled or contact.unproven) and self.now < until:
            contact.tick(self.now)  # proofs follow each other faster than PERIOD
            self.flush()
            await self.wait_for(lambda: contact.settled, PROOF_PERIOD)

    async def _prove_again(self) -> None:
        """Prove a session that was proven: since then its proofs may have been lost."""
        self.contact.operator.prove_again(self.now)
        if self.contact.operator.proves:
            await self._settle()

    async def show_neutral(self) -> None:
        """Follow the verb that has armed our vehicle: nothing moves it before the new session has shown neutral."""
        contact = self.contact
        if contact.state.has_rover_dialect and contact.state.armed and contact.state.driver == contact.ids[0]:
            await self.demand_neutral()
            contact.operator.demanding = False

    async def demand_neutral(self) -> None:
        """Demand neutral from now on; return when our vehicle reports that it counts.

        Return after NEUTRAL_LEAD where nothing is reported. One that reports that none has come gets TOLD_WITHIN more.
        """
        contact, state, began = self.contact, self.vehicle, self.now

        def counts() -> bool:
            return state.has_taken_neutral(contact.ids[0], began)

        contact.operator.demanding = True
        contact.tick(began)  # the neutral goes before the question
        self.flush()
        if not state.has_rover_dialect:
            await asyncio.sleep(NEUTRAL_LEAD)
            return
        await self.wait_for(lambda: contact.in_control, TOLD_WITHIN)
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(NEUTRAL_LEAD):
                await self.request_message(m.RoverDriveStatus, NEUTRAL_LEAD, counts)
                await self.wait_for(counts, NEUTRAL_LEAD)
        await self.wait_for(lambda: not state.needs_neutral, TOLD_WITHIN)

    async def wait_for(self, condition: Callable[[], bool], seconds: float) -> bool:
        """Wait until `condition` holds; return whether it does. Raises VerbError if a message may not be sent."""
        if condition():
            return True
        await self.wait_until_true(lambda: condition() or bool(self._refusal), seconds)
        self.need_sent()
        return condition()

    async def wait_until_true(self, condition: Callable[[], bool], seconds: float) -> bool:
        """Wait until `condition`, which is about all vehicles, holds; return whether it does."""
        if condition():
            return True
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds):  # wait_for() may lose a cancellation
                await self.core.add_waiter(condition)
        return condition()

    def explain_silence(self) -> str:
        """Return why the vehicle may answer nothing, behind "; "; "" if nothing is known."""
        return self.core.explain_silence(self.vehicle.system)

    def describe_links(self) -> str:
        """Return why no vehicle is heard, behind ": "; "" if one is, or if nothing is known."""
        if self.core.contacts:
            return ""
        self.observe()
        return describe_silence([to_view(report) for report in self.core.reports])

    @property
    def _refusal(self) -> str:
        contact = self._contact or self.core.chosen
        return contact.refusal if contact else ""

    def need_sent(self) -> None:
        """Raise VerbError if a message to the vehicle may not be sent."""
        if self._refusal:
            raise VerbError(ExitCode.REFUSED, f"{self.vehicle.name}: {self._refusal}")

    def of_others(self) -> list[VerbSession]:
        """Return a session for each vehicle that was heard, this one included."""
        others = [type(self)(self.core, self.flush, self._progress, each) for each in self.core.contacts.values()]
        for each in others:
            each.files = self.files
        return others

    async def request(self, start: RequestStart, interrupted: Interrupted | None = None) -> RequestReport:
        """Make a request and return how it ended; it is cancelled with the verb.

        Raises VerbError if its messages may not be sent.
        """
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

    def heard_at(self, kind: type[m.Message]) -> float:
        """Return when such a message of the vehicle arrived last; -infinity if none has."""
        return self.core.heard.get((self.vehicle.system, kind), -math.inf)

    async def request_message(
        self, kind: type[m.Message], within: float, told: Callable[[], bool] | None = None
    ) -> RequestReport:
        """Request a message; wait for it (or for `told`) up to `within` s, as it may follow its acknowledgement."""
        commands, began = self.services.commands, self.now
        report = await self.request(
            lambda number, now: commands.send(number, Command.REQUEST_MESSAGE, (float(kind.id),), kind.msgname, now)
        )
        if report.state is RequestState.ACCEPTED:
            await self.wait_for(told or (lambda: self.heard_at(kind) >= began), within)
        return report


def _names(contacts: Mapping[int, VehicleContact]) -> str:
    """Return what --vehicle may name: names of a fleet, else system ids."""
    return ", ".join(contacts[system].state.fleet_name or str(system) for system in sorted(contacts))
