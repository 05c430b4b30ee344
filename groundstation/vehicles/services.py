"""The MAVLink services of one vehicle, as the ground station uses them: parameters, plans, files, logs, commands.

Each request has a number and ends in `book`. Nothing is sent before the first request. Most services are made, and
their modules imported, when they are used first: importing all of them takes a verb longer than anything else.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, MutableMapping
from functools import cached_property
from typing import TYPE_CHECKING, Protocol, TypeVar

from dialects import messages as m
from dialects.enums import Autopilot, Command, Result, SystemState, VehicleType
from dialects.kinds import VehicleKind, find_kind
from groundstation.vehicles.requests.command_requests import CommandRequests
from groundstation.vehicles.requests.mode_requests import ModeRequests
from groundstation.vehicles.requests.requests import FIRST_STEP, RequestBook, RequestReport
from groundstation.vehicles.state.identity import VehicleIdentity
from groundstation.vehicles.state.plan_progress import PlanProgress
from link.core import Outgoing, Received
from link.services.command.client import CommandClient

if TYPE_CHECKING:
    from groundstation.vehicles.requests.disk_jobs import DiskJob, DiskResult
    from groundstation.vehicles.requests.file_comparing import FileComparing
    from groundstation.vehicles.requests.file_requests import FileRequests
    from groundstation.vehicles.requests.folder_cache import FolderCache
    from groundstation.vehicles.requests.log_requests import LogRequests
    from groundstation.vehicles.requests.message_requests import MessageRequests
    from groundstation.vehicles.requests.metadata_requests import MetadataRequests
    from groundstation.vehicles.requests.mission_requests import MissionRequests
    from groundstation.vehicles.requests.param_comparing import ParamComparing
    from groundstation.vehicles.requests.param_requests import ParamRequests
    from groundstation.vehicles.requests.param_storage import ParamStorage
    from groundstation.vehicles.requests.param_writer import ParamWriter
    from groundstation.vehicles.requests.plan_requests import PlanRequests
    from groundstation.vehicles.requests.transfer_requests import TransferRequests
    from groundstation.vehicles.state.vehicle_state import VehicleState

CALIBRATING = "a calibration is under way, try again when it has ended"
"""Why a vehicle refuses that reports MAV_STATE_CALIBRATING."""


class _Service(Protocol):
    """What exchanges messages with the vehicle."""

    def receive(self, received: Received, now: float) -> None: ...

    def tick(self, now: float) -> None: ...

    def cancel(self, number: int, now: float) -> None: ...


class _Client(Protocol):
    """What queues the messages of a service."""

    def messages_to_send(self) -> list[Outgoing]: ...


class _Follower(Protocol):
    """What makes requests of several steps, each a request of its own."""

    def handle_report(self, report: RequestReport, now: float) -> None: ...

    def cancel(self, number: int, now: float) -> None: ...


class _DiskUser(Protocol):
    """What reads and writes files of this machine."""

    def pop_disk_jobs(self) -> list[DiskJob]: ...

    def handle_disk(self, result: DiskResult, now: float) -> None: ...


_S = TypeVar("_S", bound=_Service)
_SERVICE_OF: Mapping[type[m.Message], str] = {
    m.ParamSet: "params",
    m.MissionCount: "plans",
    m.MissionClearAll: "plans",
    m.MissionItem: "plans",
    m.MissionItemInt: "plans",
    m.FileTransferProtocol: "files",
    m.LogErase: "logs",
}
"""Message that changes something -> the attribute of its service."""


class VehicleServices:
    """Services of the component `target` (system, component). `system` and `component` are our ids.

    `outbox` gets what is sent; while transfers wait, theirs stays with them.
    `texts` keeps downloaded texts of parameters, by the checksum of the vehicle's general metadata file.
    """

    def __init__(
        self,
        outbox: list[Outgoing],
        system: int,
        component: int,
        target: tuple[int, int],
        texts: MutableMapping[int, bytes] | None = None,
    ) -> None:
        self._outbox = outbox
        self._ids = (system, component)
        self._texts = {} if texts is None else texts
        self.autopilot: int = Autopilot.GENERIC
        """MAV_AUTOPILOT of its HEARTBEAT."""
        self.kind: int = VehicleType.GENERIC
        """MAV_TYPE of its HEARTBEAT."""
        self.book = RequestBook()
        self.lasting: set[int] = set()
        """Numbers of requests that go on with another component of the system: stops, and what is repeated."""
        self._used = False
        self.alive = True
        """The vehicle is heard."""
        self.held = False
        """The transfers wait: the line is slow, and the operator drives."""
        self._talk_to(target)

    def change_component(self, component: int, now: float) -> None:
        """Talk to another component of the same system. Requests to the former one are refused, but for `lasting`."""
        for report in self.book.running:
            if report.number not in self.lasting:
                why = f"component {component} is the autopilot, not {self._target[1]}: request it again"
                self.book.refuse(report.number, why, now, by_vehicle=False)
        for name in [name for name, each in vars(type(self)).items() if isinstance(each, cached_property)]:
            self.__dict__.pop(name, None)
        self._talk_to((self._target[0], component))

    def _talk_to(self, target: tuple[int, int]) -> None:
        self._target = target
        self.identity = VehicleIdentity(target[1])
        self.commands = CommandRequests(CommandClient(*self._ids, self._outbox), self.book, target)
        self.modes = ModeRequests(self.commands, self.identity, self.book, lambda: (self.autopilot, self.kind))
        self.progress = PlanProgress(target[1])
        self._services: list[_Service] = [self.commands]
        """Those that are made; likewise in the next four."""
        self._clients: list[_Client] = []
        self._followers: list[_Follower] = []
        self._disk_users: list[_DiskUser] = []
        self._timed: list[MetadataRequests | TransferRequests] = []

    # ---- made when they are used first ----

    def _add(self, service: _S, client: _Client) -> _S:
        self._services.append(service)
        self._clients.append(client)
        return service

    @cached_property
    def messages(self) -> MessageRequests:
        """Rates of messages, and single messages."""
        from groundstation.vehicles.requests.message_requests import MessageRequests

        return MessageRequests(self.commands, self.book)

    @cached_property
    def files(self) -> FileRequests:
        """MAVLink FTP."""
        from groundstation.vehicles.requests.file_requests import FileRequests
        from link.services.ftp.client import FtpClient

        (to, at), first = self._target, int.from_bytes(os.urandom(3))
        client = FtpClient(*self._ids, target_system=to, target_component=at, first=first)
        return self._add(FileRequests(client, self.book), client)

    @cached_property
    def plans(self) -> PlanRequests:
        """Mission, fence and rally points."""
        from groundstation.vehicles.requests.plan_requests import PlanRequests
        from link.services.mission.client import MissionClient

        to, at = self._target
        client = MissionClient(*self._ids, target_system=to, target_component=at)
        return self._add(PlanRequests(client, self.book), client)

    @cached_property
    def missions(self) -> MissionRequests:
        """The mission and places: started, paused, gone to."""
        from groundstation.vehicles.requests.mission_requests import MissionRequests

        return MissionRequests(self.commands, self.modes, self.progress, self.book, lambda: self.autopilot, self._model)

    @cached_property
    def logs(self) -> LogRequests:
        """Logs by LOG_REQUEST_LIST."""
        from groundstation.vehicles.requests.log_requests import LogRequests
        from link.services.log.client import LogClient

        to, at = self._target
        client = LogClient(*self._ids, target_system=to, target_component=at)
        return self._add(LogRequests(client, self.book), client)

    @cached_property
    def params(self) -> ParamRequests:
        """Parameters."""
        from groundstation.vehicles.requests.param_requests import ParamRequests
        from link.services.param.client import ParamClient

        to, at = self._target
        client = ParamClient(*self._ids, target_system=to, target_component=at)
        made = ParamRequests(client, lambda: self.files, self.identity, self.book, lambda: self.autopilot)
        return self._add(made, client)

    @cached_property
    def param_writer(self) -> ParamWriter:
        """Several parameters in one request."""
        from groundstation.vehicles.requests.param_writer import ParamWriter

        made = ParamWriter(self.params, self.book)
        self._followers.append(made)
        return made

    @cached_property
    def param_storage(self) -> ParamStorage:
        """The vehicle's memory of its parameters."""
        from groundstation.vehicles.requests.param_storage import ParamStorage

        return ParamStorage(self.commands, self.book, lambda: self.autopilot)

    @cached_property
    def param_file(self) -> ParamComparing:
        """The file that the parameters are compared with."""
        from groundstation.vehicles.requests.param_comparing import ParamComparing

        return ParamComparing(self.book)

    @cached_property
    def metadata(self) -> MetadataRequests:
        """The vehicle's own texts of its parameters."""
        from groundstation.vehicles.requests.metadata_requests import MetadataRequests

        made = MetadataRequests(self.files, self.identity, self._texts)
        self._timed.append(made)
        return made

    @cached_property
    def folders(self) -> FolderCache:
        """Folders that were listed."""
        from groundstation.vehicles.requests.folder_cache import FolderCache

        made = FolderCache(self.files)
        self._followers.append(made)
        return made

    @cached_property
    def transfers(self) -> TransferRequests:
        """Downloads into files of this machine, and uploads from them."""
        from groundstation.vehicles.requests.transfer_requests import TransferRequests

        made = TransferRequests(self.files, self.logs, self.book, lambda: (self.alive, self.autopilot))
        self._timed.append(made)
        self._followers.append(made)
        self._disk_users.append(made)
        return made

    @cached_property
    def comparing(self) -> FileComparing:
        """Files compared by checksum."""
        from groundstation.vehicles.requests.file_comparing import FileComparing

        made = FileComparing(self.files, self.book)
        self._followers.append(made)
        self._disk_users.append(made)
        return made

    def _model(self) -> VehicleKind:
        return find_kind(self.autopilot, self.kind)

    def note_state(self, state: VehicleState) -> None:
        """Store the state that its newest HEARTBEAT reports."""
        self.autopilot, self.kind = state.autopilot, state.kind
        if self.modes.current is None:  # the HEARTBEAT came before its services were made
            self.modes.current = state.custom_mode
        self.book.busy = CALIBRATING if state.status == SystemState.CALIBRATING else ""

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of the vehicle."""
        self.identity.receive(received)
        self.modes.receive(received, now)
        self.progress.receive(received, now)
        for service in self._services:
            service.receive(received, now)
        self._take_queries(now)
        self._release()

    def handle_text(self, text: str, severity: int, now: float) -> None:
        """Handle a whole STATUSTEXT of the vehicle."""
        self.book.handle_text(text, severity, now)

    def handle_refused(self, message: m.Message, why: str, now: float) -> None:
        """End the requests of the service whose message was not sent, because our role does not allow it."""
        self.commands.refuse(message, why)
        service: _Service | None = getattr(self, _SERVICE_OF.get(type(message), ""), None)
        if service is not None:
            with self.book.refusing(why):
                for report in self.book.running:
                    service.cancel(report.number, now)

    def calibrate(self, number: int, name: str, now: float) -> None:
        """Begin a calibration, one of KINDS."""
        from groundstation.vehicles.calibration.calibration import KINDS, REQUEST

        kind = KINDS[name]
        self.commands.send(number, kind.command, kind.params, f"{REQUEST}{name}", now)

    def end_calibration(self, number: int, now: float, *, accept: bool) -> None:
        """End the calibration of the compass: write its result, or cancel it."""
        from groundstation.vehicles.calibration.calibration import CANCEL, REQUEST, WRITE

        command, what = (Command.DO_ACCEPT_MAG_CAL, WRITE) if accept else (Command.DO_CANCEL_MAG_CAL, CANCEL)
        self.commands.send(number, command, (0,), f"{REQUEST}{what}", now)

    def cancel(self, number: int, now: float) -> None:
        """Cancel a request."""
        for service in self._services:
            service.cancel(number, now)
        for follower in self._followers:
            follower.cancel(number, now)

    def tick(self, now: float, *, may_query: bool = True, alive: bool = True, held: bool = False) -> None:
        """Repeat what is overdue, report progress, give up at last.

        `may_query`: no other REQUEST_MESSAGE of ours is under way, whose COMMAND_ACK would be taken for ours.
        `alive`: the vehicle is heard. `held`: parameters, plans, files and logs wait, commands do not.
        """
        self._used = self._used or bool(self.book.running)
        self.alive, self.held = alive, held
        for service in self._services:
            if not held or service is self.commands:
                service.tick(now)
        for timed in self._timed:
            timed.tick(now)
        self._take_queries(now)
        self.modes.tick(now)
        if self._used and may_query:
            self._query_identity(now)
        self.book.tick(now)

    def pop_reports(self, now: float) -> list[RequestReport]:
        """Return the newest report of each request that has changed since the last call, and send what follows."""
        found: dict[int, RequestReport] = {}
        while reports := self.book.pop_changes():  # a request of several steps goes on when one has ended
            for report in reports:
                for follower in self._followers:
                    follower.handle_report(report, now)
                if report.number > FIRST_STEP:
                    found[report.number] = report
        self._release()
        return list(found.values())

    def pop_disk_jobs(self) -> list[DiskJob]:
        """Return what the disk shall do, once."""
        return [job for user in self._disk_users for job in user.pop_disk_jobs()]

    def handle_disk(self, result: DiskResult, now: float) -> None:
        """Go on with what the disk has answered."""
        for user in self._disk_users:
            user.handle_disk(result, now)

    def _release(self) -> None:
        """Pass on what the transfers send, unless they wait."""
        if not self.held:
            for client in self._clients:
                self._outbox += client.messages_to_send()

    def _query_identity(self, now: float) -> None:
        if self.commands.is_waiting(Command.REQUEST_MESSAGE):
            return
        request = self.identity.next_request(now)
        if request is not None:
            self.commands.query(Command.REQUEST_MESSAGE, (request.message, request.index), now)

    def _take_queries(self, now: float) -> None:
        for outcome in self.commands.pop_queries():
            if outcome.command == Command.DO_SET_MODE:
                self.modes.handle_outcome(outcome, now)
            elif outcome.result is not Result.ACCEPTED:
                self.identity.handle_refusal()
