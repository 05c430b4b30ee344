"""Requests of the operator to the services of vehicles, such as their parameters, and how they end.

The services of a vehicle exist from the first request on: a vehicle that is only driven costs nothing.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, MutableMapping
from typing import TYPE_CHECKING

from dialects.enums import Command, Severity
from groundstation.natural_order import natural_key
from groundstation.snapshot.log_origin import LogOrigin
from groundstation.station.driving.commander import Commander
from groundstation.station.driving.operator import OperatorSession
from groundstation.station.links.link_stats import LinkStats
from groundstation.station.outbox import StationOutbox
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.vehicles.services import VehicleServices
from groundstation.vehicles.state.message_log import MessageLog
from groundstation.views.requests import RequestLine, RequestsRequest, RequestsView
from link.core import Received

if TYPE_CHECKING:  # what only screens need: a verb of its own process does without
    from groundstation.intents.services import ServiceIntent
    from groundstation.station.view_feed import ViewSource
    from groundstation.vehicles.requests.disk_jobs import DiskJob, DiskResult
    from groundstation.vehicles.requests.folder_cache import ListedFolder
    from groundstation.views.base import ViewRequest
    from groundstation.views.files import FilesRequest, FilesView, FolderRow

SLOW_LINE = 20_000.0
"""Bytes/s below which transfers wait while the operator drives: a telemetry radio has 5.8 k, 115200 baud 11.5 k."""


class TransferPause:
    """Decides whether parameters, plans, files and logs wait: on a slow line they would delay a driver's demands."""

    def __init__(self, fleet: Fleet, operator: OperatorSession, links: LinkStats) -> None:
        self._fleet = fleet
        self._operator = operator
        self._links = links

    def is_held(self, contact: Contact, now: float) -> bool:
        """Return whether the transfers of a vehicle wait: the operator drives over the same, slow line."""
        selected = self._fleet.selected
        if selected is None or selected.link != contact.link or self._operator.demand(now).neutral:
            return False
        capacity = self._links.capacity(contact.link)
        return capacity is not None and capacity < SLOW_LINE


KEPT_REPORTS = 16
"""Requests of one service whose end a screen can still read."""

_SEVERITIES = {RequestState.REFUSED: Severity.WARNING, RequestState.NO_ANSWER: Severity.WARNING}


class ServiceRequests:
    """The services of all vehicles. `system` and `component` are our ids; `texts`: see VehicleServices."""

    def __init__(
        self,
        fleet: Fleet,
        commander: Commander,
        log: MessageLog,
        outbox: StationOutbox,
        system: int,
        component: int,
        *,
        texts: MutableMapping[int, bytes] | None = None,
        is_held: Callable[[Contact, float], bool] = lambda contact, now: False,
    ) -> None:
        """`is_held` says whether the transfers of a vehicle wait: for the operator who drives over a slow line."""
        self._is_held = is_held
        self._fleet = fleet
        self._commander = commander
        self._log = log
        self._outbox = outbox.services
        self._ids = (system, component)
        self._texts: MutableMapping[int, bytes] = {} if texts is None else texts
        self._service_of: dict[int, str] = {}
        """Number of a request -> name of its service."""
        self._ended: dict[str, deque[RequestLine]] = {}
        self._followed: dict[int, Callable[[RequestReport], None]] = {}
        """Number of a request -> what gets its reports."""

    # ---- requests ----

    def start(self, intent: ServiceIntent, now: float) -> None:
        """Make a request; without its vehicle it ends at once."""
        self._service_of[intent.request] = intent.service
        contact = self._fleet.get(intent.system) if intent.system else self._fleet.selected
        if contact is None:
            report = RequestReport(intent.request, intent.what, RequestState.REFUSED, "no vehicle yet")
            self._end(report, 0, "station", now)
            return
        intent.start(self.services_of(contact), now)
        self.collect(now)

    def cancel(self, number: int, now: float) -> None:
        """Cancel a request to any vehicle."""
        for contact in self._fleet:
            if contact.services is not None:
                contact.services.cancel(number, now)
        self.collect(now)

    # ---- core ----

    def receive(self, contact: Contact, received: Received, now: float) -> None:
        """Handle a message of a vehicle."""
        if contact.services is not None:
            contact.services.receive(received, now)

    def handle_text(self, contact: Contact, text: str, severity: int, now: float) -> None:
        """Handle a whole STATUSTEXT of a vehicle."""
        if contact.services is not None:
            contact.services.handle_text(text, severity, now)

    def tick(self, now: float) -> None:
        """Repeat what is overdue, give up at last, report what has ended."""
        for contact in self._fleet:
            if contact.services is not None:
                contact.services.note_state(contact.state)
                pending = self._commander.is_pending(Command.REQUEST_MESSAGE, contact.state)
                alive, held = contact.state.monitor.is_alive(now), self._is_held(contact, now)
                contact.services.tick(now, may_query=not pending, alive=alive, held=held)
        self.collect(now)

    @property
    def busy(self) -> bool:
        """Whether a request to any vehicle is under way."""
        return any(contact.services is not None and contact.services.book.running for contact in self._fleet)

    def is_querying(self, contact: Contact) -> bool:
        """Return whether a REQUEST_MESSAGE to this vehicle is under way: another would be taken for it."""
        return contact.services is not None and contact.services.commands.is_waiting(Command.REQUEST_MESSAGE)

    def is_setting_rate(self, contact: Contact) -> bool:
        """Return whether a SET_MESSAGE_INTERVAL of the operator is under way: another would be taken for it."""
        return contact.services is not None and contact.services.commands.is_waiting(Command.SET_MESSAGE_INTERVAL)

    # ---- the disk ----

    def pop_disk_jobs(self) -> list[DiskJob]:
        """Return what the disk shall do for the vehicles, once."""
        found = (contact.services for contact in self._fleet if contact.services is not None)
        return [job for services in found for job in services.pop_disk_jobs()]

    def handle_disk(self, result: DiskResult, now: float) -> None:
        """Handle an answer of the disk."""
        for contact in self._fleet:
            if contact.services is not None:
                contact.services.handle_disk(result, now)
        self.collect(now)

    def cancel_transfers(self, now: float) -> None:
        """Cancel all transfers when the station ends; what has arrived is kept."""
        for contact in self._fleet:
            if contact.services is not None:
                contact.services.transfers.cancel_all(now)

    # ---- views ----

    @property
    def sources(self) -> Mapping[type[ViewRequest], ViewSource]:
        """Request -> its source."""
        from groundstation.station.view_feed import ViewSource
        from groundstation.views.files import FilesRequest

        return {
            RequestsRequest: ViewSource(self.build_requests, period=0.25),
            FilesRequest: ViewSource(self.build_files, period=0.25),
        }

    @property
    def progress(self) -> float | None:
        """How far the downloads and uploads under way are, 0..1; None without one."""
        running = [line for line in self._running() if line.service == "files"]
        known = [(line.done, line.total) for line in running if line.total]
        whole = sum(total for _, total in known)
        return None if not running else sum(done for done, _ in known) / whole if whole else 0.0

    def build_files(self, request: FilesRequest, now: float, wall: float) -> FilesView | None:
        """Build the view of the files of the selected vehicle; None without a vehicle."""
        selected = self._fleet.selected
        return None if selected is None else build_files(selected, request)

    def build_requests(self, request: RequestsRequest, now: float, wall: float) -> RequestsView:
        """Build the view of all requests."""
        return RequestsView(tuple(self._running()), tuple(line for lines in self._ended.values() for line in lines))

    def requests_of(self, service: str, system: int) -> RequestsView:
        """Return the requests of one service: what runs at this vehicle, and what has ended."""
        running = (line for line in self._running() if line.service == service and line.system == system)
        return RequestsView(tuple(running), tuple(self._ended.get(service, ())))

    # ---- parts ----

    def _running(self) -> list[RequestLine]:
        """Return the requests under way; steps of a request have numbers below 0."""
        return [
            self._line(report, contact.state.system, _waits(contact.services, report.number))
            for contact in self._fleet
            if contact.services is not None
            for report in contact.services.book.running
            if report.number >= 0
        ]

    def services_of(self, contact: Contact) -> VehicleServices:
        """Return the services of a vehicle."""
        if contact.services is None:
            target = (contact.state.system, contact.state.component)
            contact.services = VehicleServices(self._outbox, *self._ids, target, self._texts)
            contact.services.note_state(contact.state)
        return contact.services

    def follow(self, number: int, tell: Callable[[RequestReport], None]) -> None:
        """Call `tell` with each report of a request up to its end, in place of keeping the last one for screens."""
        self._followed[number] = tell

    def collect(self, now: float) -> None:
        """Log what has ended."""
        for contact in self._fleet:
            if contact.services is None:
                continue
            for report in contact.services.pop_reports(now):
                if report.state.ended:
                    self._end(report, contact.state.system, contact.state.name, now)
                elif (tell := self._followed.get(report.number)) is not None:
                    tell(report)

    def _end(self, report: RequestReport, system: int, name: str, now: float) -> None:
        severity = _SEVERITIES.get(report.state, Severity.INFO)
        self._log.add(now, "ack", f"{name}: {report.text}", severity, origin=LogOrigin(system))
        if (tell := self._followed.pop(report.number, None)) is not None:
            tell(report)
        elif report.number >= 0:
            line = self._line(report, system)
            self._ended.setdefault(line.service, deque(maxlen=KEPT_REPORTS)).append(line)
            self._service_of.pop(report.number, None)

    def _line(self, report: RequestReport, system: int, waits: str = "") -> RequestLine:
        """Return a report for a screen; one that has a reason of the vehicle shows it last."""
        return RequestLine(
            number=report.number,
            state=report.state.value,
            what=report.what,
            detail=f"{report.detail}: {report.reason}" if report.reason else report.detail,
            done=report.done,
            total=report.total,
            service=self._service_of.get(report.number, ""),
            waits=waits,
            kept=report.kept,
            system=system,
        )


def _waits(services: VehicleServices, number: int) -> str:
    if services.transfers.waits(number):
        return "waits for the vehicle to be back"
    return "waits: you drive, and the line is slow" if services.held else ""


MAX_ROWS = 2000
"""Entries of all folders of one view, which is a packet of at most 256 kB."""


def build_files(contact: Contact, request: FilesRequest) -> FilesView:
    """Return what was listed so far, of one vehicle."""
    from groundstation.vehicles.requests.transfer_requests import log_ending  # with FTP, which a verb does without
    from groundstation.views.files import FilesView, VehicleLog

    services = contact.services
    logs = services.logs.logs if services else None
    listed = services.folders.folders if services else {}
    return FilesView(
        system=contact.state.system,
        name=contact.state.name,
        log_ending=log_ending(contact.state.autopilot),
        logs=None if logs is None else tuple(VehicleLog(each.number, each.begun, each.size) for each in logs),
        folders=tuple(_folders(request.folders, listed)),
    )


def _folders(paths: tuple[str, ...], listed: dict[str, ListedFolder]) -> list[FolderRow]:
    from groundstation.views.files import FileRow, FolderRow

    rows, room = [], MAX_ROWS
    for path in paths:
        folder = listed.get(path)
        if folder is not None:
            found = sorted(folder.entries, key=lambda entry: (entry.size is not None, natural_key(entry.name)))
            entries = tuple(FileRow(entry.name, entry.size) for entry in found[:room])
            rows.append(FolderRow(path, entries, folder.problem))
            room -= len(entries)
    return rows
