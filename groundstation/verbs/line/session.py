"""LineSession: the session of a verb that runs in a station (station_seat.py), for a line of the screens."""

from __future__ import annotations

from collections.abc import Callable

from groundstation.intents.base import Intent
from groundstation.station.operator_core import OperatorCore
from groundstation.vehicles.demand.stop_commands import StopKind
from groundstation.vehicles.fleet import Contact
from groundstation.vehicles.requests.requests import RequestReport
from groundstation.verbs.collected_output import one_line
from groundstation.verbs.session.contact import VehicleContact
from groundstation.verbs.session.core import VerbCore
from groundstation.verbs.session.session import Interrupted, RequestStart, VerbSession
from groundstation.verbs.session.station_seat import StationSeat


class LineSession(VerbSession):
    """For the vehicle that the operator has chosen. The station proves its session, and goes on behind the verb."""

    def __init__(self, station: OperatorCore, contact: Contact, flush: Callable[[], None]) -> None:
        core = VerbCore(station, contact.state.system)
        self.seat = StationSeat(station, core, "a line", flush)
        super().__init__(core, self.seat.flush, lambda report: None, VehicleContact(station, contact, core.outbox, 0.0))
        self.selects = contact
        self.told: list[str] = []
        """How its requests have ended; the log has these lines already."""
        self.afterwards = ""
        """Nothing: the station goes on."""

    @property
    def is_selected(self) -> bool:
        """Whether it is the vehicle that the operator has selected."""
        return self.core.station.fleet.selected is self.selects

    def do(self, *intents: Intent) -> None:
        """Carry out intents, which go to the selected vehicle."""
        for intent in intents:
            self.core.station.handle_intent(intent, self.now)
        self.flush()

    def stop(self, kind: StopKind, *intents: Intent) -> None:
        """Stop the vehicle: by the intents of its key if it is the selected one."""
        if self.is_selected:
            self.do(*intents)
            return
        self.core.station.stop(kind, self.selects, self.now)
        self.flush()

    async def need_only_vehicle(self, wanted: int | str | None) -> None:
        """Do nothing: the operator has chosen the vehicle."""

    def explain_silence(self) -> str:
        """Return nothing: the header of each screen says how the vehicle signs."""
        return ""

    async def prove_session(self) -> None:
        """Do nothing: the station proves its session."""

    async def request(self, start: RequestStart, interrupted: Interrupted | None = None) -> RequestReport:
        """Make a request and return how it ended."""
        report = await super().request(start, interrupted)
        self.told.append(f"{self.vehicle.name}: {report.text}")
        return report


def here(text: str) -> str:
    """Return a text for a shell as one line for a screen: verbs are written behind a colon here."""
    return one_line(text).replace("`mavhelm ", "`:")
