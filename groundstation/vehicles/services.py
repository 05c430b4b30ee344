"""The MAVLink services of one vehicle, as the ground station uses them: parameters, plans, files, logs, commands.

Each request has a number and ends in `book`. Nothing is sent before the first request.
"""

from __future__ import annotations

from collections.abc import MutableMapping

from dialects.enums import Autopilot, Command, Result, VehicleType
from groundstation.vehicles.command_requests import CommandRequests
from groundstation.vehicles.file_requests import FileRequests
from groundstation.vehicles.folder_cache import FolderCache
from groundstation.vehicles.identity import VehicleIdentity
from groundstation.vehicles.log_requests import LogRequests
from groundstation.vehicles.message_requests import MessageRequests
from groundstation.vehicles.metadata_requests import MetadataRequests
from groundstation.vehicles.mode_requests import ModeRequests
from groundstation.vehicles.param_comparing import ParamComparing
from groundstation.vehicles.param_requests import ParamRequests
from groundstation.vehicles.param_storage import ParamStorage
from groundstation.vehicles.param_writer import ParamWriter
from groundstation.vehicles.plan_requests import PlanRequests
from groundstation.vehicles.requests import RequestBook, RequestReport
from groundstation.vehicles.transfer_requests import TransferRequests
from link.core import Outgoing, Received
from link.services.command.client import CommandClient
from link.services.ftp.client import FtpClient
from link.services.log.client import LogClient
from link.services.mission.client import MissionClient
from link.services.param.client import ParamClient


class VehicleServices:
    """Services of the component `target` (system, component). `system` and `component` are our ids.

    `texts` keeps downloaded texts of parameters, by the checksum of the vehicle's general metadata file.
    """

    def __init__(
        self, system: int, component: int, target: tuple[int, int], texts: MutableMapping[int, bytes] | None = None
    ) -> None:
        to, at = target
        self.autopilot: int = Autopilot.GENERIC
        """MAV_AUTOPILOT of its HEARTBEAT."""
        self.kind: int = VehicleType.GROUND_ROVER
        """MAV_TYPE of its HEARTBEAT."""
        self.book = RequestBook()
        self.identity = VehicleIdentity(at)
        self.commands = CommandRequests(CommandClient(system, component), self.book, target)
        self.messages = MessageRequests(self.commands, self.book)
        self.modes = ModeRequests(self.commands, self.identity, self.book, lambda: (self.autopilot, self.kind))
        self.files = FileRequests(FtpClient(system, component, target_system=to, target_component=at), self.book)
        self.plans = PlanRequests(MissionClient(system, component, target_system=to, target_component=at), self.book)
        self.logs = LogRequests(LogClient(system, component, target_system=to, target_component=at), self.book)
        params = ParamClient(system, component, target_system=to, target_component=at)
        self.params = ParamRequests(params, self.files, self.identity, self.book, lambda: self.autopilot)
        self.param_writer = ParamWriter(self.params, self.book)
        self.param_storage = ParamStorage(self.commands)
        self.param_file = ParamComparing(self.book)
        self.metadata = MetadataRequests(self.files, self.identity, {} if texts is None else texts)
        self.folders = FolderCache(self.files)
        self.transfers = TransferRequests(self.files, self.logs, self.book)
        self._services = (self.commands, self.files, self.logs, self.plans, self.params)
        self._used = False
        self.held = False
        """The transfers wait: the line is slow, and the operator drives."""

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of the vehicle."""
        self.identity.receive(received)
        self.modes.receive(received, now)
        for service in self._services:
            service.receive(received, now)
        self._take_queries(now)

    def handle_text(self, text: str, severity: int, now: float) -> None:
        """Take a whole STATUSTEXT of the vehicle."""
        self.book.handle_text(text, severity, now)

    def cancel(self, number: int, now: float) -> None:
        """Cancel a request."""
        for service in self._services:
            service.cancel(number, now)
        self.param_writer.cancel(number)
        self.transfers.cancel(number, now)

    def tick(self, now: float, *, may_query: bool = True, alive: bool = True, held: bool = False) -> None:
        """Repeat what is overdue, report progress, give up at last.

        `may_query`: no other REQUEST_MESSAGE of ours is under way, whose COMMAND_ACK would be taken for ours.
        `alive`: the vehicle is heard. `held`: parameters, plans, files and logs wait, commands do not.
        """
        self._used = self._used or bool(self.book.running)
        self.held = held
        self.transfers.alive, self.transfers.autopilot = alive, self.autopilot
        for service in self._services:
            if not held or service is self.commands:
                service.tick(now)
        self.transfers.tick(now)
        self._take_queries(now)
        self.modes.tick(now)
        self.metadata.tick(now)
        if self._used and may_query:
            self._query_identity(now)
        self.book.tick(now)

    def pop_reports(self, now: float) -> list[RequestReport]:
        """Return the newest report of each request that has changed since the last call."""
        found: dict[int, RequestReport] = {}
        while reports := self.book.pop_changes():  # a request of several steps goes on when one has ended
            for report in reports:
                self.param_writer.handle_report(report, now)
                self.transfers.handle_report(report, now)
                self.folders.handle_report(report)
                if not self.transfers.owns(report.number):
                    found[report.number] = report
        return list(found.values())

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them."""
        sending = (self.commands,) if self.held else self._services
        return [outgoing for service in sending for outgoing in service.messages_to_send()]

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
