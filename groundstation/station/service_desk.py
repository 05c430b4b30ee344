"""Requests of the operator to the services of a vehicle, such as its parameters, and how they end.

The services of a vehicle exist from the first request on: a vehicle that is only driven costs nothing.
"""

from __future__ import annotations

from collections import deque

from dialects.enums import Command, Severity
from groundstation.station.commander import Commander
from groundstation.station.param_view import build_param_page, request_line
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.message_log import MessageLog
from groundstation.vehicles.param_writer import ParamWriter
from groundstation.vehicles.requests import RequestReport, RequestState
from groundstation.vehicles.services import VehicleServices
from groundstation.views import ParamPage, ParamPageRequest, RequestLine
from link.core import Outgoing, Received

KEPT_REPORTS = 16
"""Requests whose end a screen can still read."""

_SEVERITIES = {RequestState.REFUSED: Severity.WARNING, RequestState.NO_ANSWER: Severity.WARNING}


class ServiceDesk:
    """The services of all vehicles. `system` and `component` are our ids."""

    def __init__(self, fleet: Fleet, commander: Commander, log: MessageLog, system: int, component: int) -> None:
        self._fleet = fleet
        self._commander = commander
        self._log = log
        self._ids = (system, component)
        self._writers: dict[int, ParamWriter] = {}
        self._ended: deque[RequestLine] = deque(maxlen=KEPT_REPORTS)

    # ---- requests ----

    def fetch_params(self, number: int, now: float) -> None:
        """Fetch all parameters of the selected vehicle."""
        selected = self._fleet.selected
        services = self._services(selected, number, "fetch parameters", now)
        if services is not None:
            services.params.fetch(number, now)
            self._collect(now)

    def write_params(self, number: int, system: int, changes: tuple[tuple[str, float], ...], now: float) -> None:
        """Set parameters of this vehicle, one after the other; stop at the first that is not set."""
        contact = self._fleet.get(system)
        if self._services(contact, number, "set parameters", now) is not None:
            self._writers[system].write(number, changes, now)
            self._collect(now)

    def cancel(self, number: int, now: float) -> None:
        """Cancel a request to any vehicle."""
        for contact in self._fleet:
            if contact.services is not None:
                contact.services.cancel(number, now)
                self._writers[contact.state.system].cancel(number)
        self._collect(now)

    # ---- core ----

    def receive(self, contact: Contact, received: Received, now: float) -> None:
        """Handle a message of a vehicle."""
        if contact.services is not None:
            contact.services.receive(received, now)

    def handle_text(self, contact: Contact, text: str, severity: int, now: float) -> None:
        """Take a whole STATUSTEXT of a vehicle."""
        if contact.services is not None:
            contact.services.handle_text(text, severity, now)

    def tick(self, now: float) -> None:
        """Repeat what is overdue, give up at last, report what has ended."""
        for contact in self._fleet:
            if contact.services is not None:
                contact.services.autopilot, contact.services.kind = contact.state.autopilot, contact.state.kind
                pending = self._commander.is_pending(Command.REQUEST_MESSAGE, contact.state)
                contact.services.tick(now, may_query=not pending)
        self._collect(now)

    def is_querying(self, contact: Contact) -> bool:
        """Return whether a REQUEST_MESSAGE to this vehicle is under way: another would be taken for it."""
        return contact.services is not None and contact.services.commands.is_waiting(Command.REQUEST_MESSAGE)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now and clear the queue."""
        found = (contact.services for contact in self._fleet if contact.services is not None)
        return [outgoing for services in found for outgoing in services.messages_to_send()]

    # ---- views ----

    def build_param_page(self, request: ParamPageRequest, now: float, wall: float) -> ParamPage | None:
        """Build the page of the selected vehicle; None without a vehicle."""
        selected = self._fleet.selected
        return build_param_page(selected, request, tuple(self._ended)) if selected else None

    # ---- parts ----

    def _services(self, contact: Contact | None, number: int, what: str, now: float) -> VehicleServices | None:
        """Return the services of a vehicle; without a vehicle the request ends at once."""
        if contact is None:
            self._end(RequestReport(number, what, RequestState.REFUSED, "no vehicle yet"), "station", now)
            return None
        if contact.services is None:
            target = (contact.state.system, contact.state.component)
            contact.services = VehicleServices(*self._ids, target)
            contact.services.autopilot = contact.state.autopilot
            self._writers[target[0]] = ParamWriter(contact.services.params, contact.services.book)
        return contact.services

    def _collect(self, now: float) -> None:
        """Log what has ended, and let the writers go on."""
        for contact in self._fleet:
            while contact.services is not None and (reports := contact.services.book.pop_changes()):
                for report in reports:
                    if report.state.ended:
                        self._end(report, contact.state.name, now)
                    self._writers[contact.state.system].handle_report(report, now)

    def _end(self, report: RequestReport, name: str, now: float) -> None:
        self._log.add(now, "ack", f"{name}: {report.text}", _SEVERITIES.get(report.state, Severity.INFO))
        if report.number >= 0:
            self._ended.append(request_line(report))
