"""LineSession: what a verb does with a vehicle of the running station, in place of a VerbSession with its own links."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from itertools import count

import msgspec

from groundstation.intents.base import Intent
from groundstation.station.station import Station
from groundstation.vehicles.demand.stop_commands import StopKind
from groundstation.vehicles.fleet import Contact
from groundstation.vehicles.requests.requests import RequestReport
from groundstation.vehicles.services import VehicleServices
from groundstation.vehicles.state.vehicle_details import VehicleDetails
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.verbs.session.in_control import is_in_control, other_driver
from groundstation.verbs.session.session import RequestStart

LOOK_PERIOD = 0.05
"""s between two looks whether what a verb waits for is so."""
NUMBERS = count(1 << 40)
"""Numbers of requests, far from those that screens take."""


class LineContact(msgspec.Struct, frozen=True):
    """The vehicle, as verbs see it."""

    contact: Contact
    ids: tuple[int, int]
    session: int

    @property
    def state(self) -> VehicleState:
        """What it reports."""
        return self.contact.state

    @property
    def details(self) -> VehicleDetails:
        """What else it reports."""
        return self.contact.details

    @property
    def in_control(self) -> bool:
        """This station is in control, as the vehicle reports it."""
        return is_in_control(self.state, self.ids, self.session)

    @property
    def other_driver(self) -> int | None:
        """System id of another program in control; None if there is none, or the vehicle does not tell."""
        return other_driver(self.state, self.ids, self.session)


class LineSession:
    """Has the parts of VerbSession that the verbs of line/rules.py use."""

    def __init__(self, station: Station, contact: Contact, ids: tuple[int, int], flush: Callable[[], None]) -> None:
        self._station = station
        self.flush = flush
        self.contact = LineContact(contact, ids, station.operator.session)
        self.services: VehicleServices = station.services.services_of(contact)
        self.told: list[str] = []
        """How its requests have ended; the log has these lines already."""
        self.afterwards = ""
        """Nothing: the station goes on."""

    @property
    def now(self) -> float:
        """The time of the loop's clock, s."""
        return asyncio.get_running_loop().time()

    @property
    def vehicle(self) -> VehicleState:
        """The vehicle."""
        return self.contact.state

    @property
    def is_selected(self) -> bool:
        """Whether it is the vehicle that the operator has selected."""
        return self._station.fleet.selected is self.contact.contact

    def do(self, *intents: Intent) -> None:
        """Carry out intents, which go to the selected vehicle."""
        for intent in intents:
            self._station.handle_intent(intent, self.now)
        self.flush()

    def stop(self, kind: StopKind, *intents: Intent) -> None:
        """Stop the vehicle: by the intents of its key if it is the selected one."""
        if self.is_selected:
            self.do(*intents)
            return
        self._station.stop(kind, self.contact.contact, self.now)
        self.flush()

    async def need_only_vehicle(self, wanted: int | str | None) -> None:
        """Do nothing: the operator has chosen the vehicle."""

    def explain_silence(self) -> str:
        """Return nothing: the header of each screen says how the vehicle signs."""
        return ""

    async def take_part(self) -> None:
        """Do nothing: the station proves its session."""

    async def wait_for(self, condition: Callable[[], bool], seconds: float) -> bool:
        """Wait until `condition` holds; return whether it does."""
        until = self.now + seconds
        while not condition() and self.now < until:  # noqa: ASYNC110 - what it waits for has no event
            await asyncio.sleep(LOOK_PERIOD)
        return condition()

    async def request(self, start: RequestStart) -> RequestReport:
        """Make a request and return how it ended."""
        ended: asyncio.Future[RequestReport] = asyncio.get_running_loop().create_future()
        number = next(NUMBERS)
        self._station.services.follow(number, lambda report: _end(ended, report))
        start(number, self.now)
        self._station.services.collect(self.now)
        self.flush()
        try:
            report = await ended
        except asyncio.CancelledError:
            self._station.services.cancel(number, self.now)
            raise
        self.told.append(f"{self.vehicle.name}: {report.text}")
        return report


def _end(ended: asyncio.Future[RequestReport], report: RequestReport) -> None:
    if report.state.ended and not ended.done():
        ended.set_result(report)


class LineOutput:
    """Collects what a verb prints. It has the methods of Output."""

    as_json = False

    def __init__(self) -> None:
        self.lines: list[str] = []
        """Data."""
        self.notes: list[str] = []
        """What an operator should know, and errors."""

    def line(self, text: str) -> None:
        """Take a line of data."""
        self.lines.append(text)

    def record(self, **fields: object) -> None:
        """Ignore what is for --json."""

    def result(self, ok: bool, vehicle: int | None, **fields: object) -> None:
        """Ignore what is for --json."""

    def flush(self) -> None:
        """Do nothing."""

    def note(self, text: str) -> None:
        """Take something worth knowing."""
        self.notes.append(here(text))

    def error(self, text: str) -> None:
        """Take an error."""
        self.note(text)

    def progress(self, report: RequestReport) -> None:
        """Ignore progress: screens show it."""


def here(text: str) -> str:
    """Return a text for a shell as one line for a screen: verbs are written behind a colon here."""
    return " ".join(text.split()).replace("`groundstation ", "`:")
