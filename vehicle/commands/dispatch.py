"""Builds the handlers of messages and commands, and collects their rows in one table each."""

from __future__ import annotations

from typing import NamedTuple

from dialects import messages as m
from link.core import Outgoing, Received
from link.services import timesync
from link.services.command.server import CommandServer
from vehicle.accessories.accessory_set import AccessorySet
from vehicle.commands.access import Access
from vehicle.commands.accessories import AccessoryCommands
from vehicle.commands.actuator_test import ActuatorTest
from vehicle.commands.arming import ArmingCommands
from vehicle.commands.calibration import CalibrationCommand
from vehicle.commands.camera import CameraCommands
from vehicle.commands.command_table import CommandTable, build_handlers, do_items
from vehicle.commands.context import COMPONENT, Context, Reporting
from vehicle.commands.demands import DemandMessages
from vehicle.commands.fence import FenceCommands
from vehicle.commands.files import FileServices
from vehicle.commands.go_to import GoToItems
from vehicle.commands.guided import GuidedCommands
from vehicle.commands.inbound import Effect, InboundMessage, InboundTable
from vehicle.commands.mission import MissionService
from vehicle.commands.origin import OriginCommands
from vehicle.commands.params import ParamService
from vehicle.commands.preflight import PreflightCommands
from vehicle.commands.preflight_storage import PreflightStorage
from vehicle.commands.proximity import ProximityMessages
from vehicle.commands.reboot import RebootRequest
from vehicle.commands.requests import MessageRequestHandler
from vehicle.commands.signing import Pairing, SigningCommands
from vehicle.storage.logbook import Logbook, LogRecorder
from vehicle.storage.param_store import ParamStore
from vehicle.storage.plan_store import PlanStore


class Stores(NamedTuple):
    """What is saved beyond the end of the program; None saves nothing."""

    params: ParamStore | None = None
    plans: PlanStore | None = None
    logs: LogRecorder | None = None
    pairing: Pairing | None = None


class Dispatcher:
    """Owns the handlers. `messages` routes what arrives, and `tick` advances what is under way."""

    def __init__(self, context: Context, reporting: Reporting, stores: Stores, accessories: AccessorySet) -> None:
        self._ids = context.ids
        self._telemetry = reporting.telemetry
        self._accessories = AccessoryCommands(context, accessories)
        self._params = ParamService(context, stores.params)
        self._preflight = PreflightCommands(context)
        self.signing = SigningCommands(context, stores.pairing)
        self.logbook = Logbook(context.params, context.control, context.statustext, context.safety, stores.logs)
        self.actuator_test = ActuatorTest(context)
        self.demands = DemandMessages(context)
        arming, guided = ArmingCommands(context), GuidedCommands(context)
        origin, fence = OriginCommands(context, reporting), FenceCommands(context)
        do_tables = (*guided.commands(), *fence.commands(), *self._accessories.commands())
        go_to = GoToItems(context, guided.drive_to)
        self._mission = MissionService(context, do_items(do_tables), go_to.handle, stores.plans)
        self._files = FileServices(context, self.logbook, self._mission.folder())
        self.camera = CameraCommands(context, reporting)
        builders = {**self._files.message_builders(), **self.camera.message_builders()}
        requests = MessageRequestHandler(reporting, builders, self.camera.note_request)
        storage = PreflightStorage(context, self._params, self._mission)

        self.commands: CommandTable = (
            *arming.commands(),
            *do_tables,
            *origin.commands(),
            *self._mission.commands(),
            *self.actuator_test.commands(),
            *storage.commands(),
            *CalibrationCommand(context).commands(),
            *self._preflight.commands(),
            *requests.commands(),
            *self.camera.commands(),
        )
        self._specs = {row.command: row for row in self.commands}
        self._server = CommandServer(
            build_handlers(self.commands, context.access), system=context.control.system, component=COMPONENT
        )
        self.messages: InboundTable = (
            *self.demands.messages(),
            *guided.messages(),
            *self._messages(),
            *arming.messages(),
            *origin.messages(),
            *self.signing.messages(),
            *ProximityMessages(context).messages(),
            *self._params.messages(),
            *self._mission.messages(),
            *self._files.messages(),
        )

    def reboot_request(self, now: float) -> RebootRequest | None:
        """Return how the program must end because a ground station requested it, or None."""
        return self._preflight.reboot_request(now)

    def tick(self, now: float) -> list[Outgoing]:
        """Return the next messages of what is under way."""
        outgoing = [
            *self._server.tick(now),
            *self._params.tick(now),
            *self._files.tick(now),
            *self._mission.tick(now),
            *self.logbook.tick(now),
        ]
        self._accessories.update(now)
        self.signing.tick(now)
        return outgoing

    def check_storage(self, now: float) -> None:
        """Check about once a second that parameters and logs are written."""
        self._params.observe(now)
        self.logbook.check_health(now)

    def _messages(self) -> InboundTable:
        """Return the rows of the messages that need nothing but a server or telemetry."""
        telemetry = self._telemetry
        anyone = Access.ANYONE
        return (
            InboundMessage(m.Heartbeat, anyone, "introduces its sender", telemetry.handle_introduction),
            InboundMessage(m.CommandLong, anyone, "command, see below", self._handle_command, Effect.MOTION),
            InboundMessage(m.CommandInt, anyone, "command, see below", self._handle_command, Effect.MOTION),
            InboundMessage(m.CommandCancel, anyone, "cancels a long-running command of its sender",
                           self._handle_cancel, Effect.MOTION),
            InboundMessage(m.RequestDataStream, Access.INTRODUCED, "sets the rate of a group of streams",
                           telemetry.handle_request_data_stream),
            InboundMessage(m.RadioStatus, anyone, "slows telemetry down while the radio's buffer is full",
                           telemetry.handle_radio_status),
            InboundMessage(m.Timesync, anyone, "answered with the clock of the vehicle", self._handle_timesync),
            InboundMessage(m.Ping, anyone, "answered", self._handle_timesync),
        )  # fmt: skip

    def _handle_command(self, received: Received, message: m.CommandLong | m.CommandInt, now: float) -> list[Outgoing]:
        if message.target_system == 0:
            spec = self._specs.get(message.command)
            if spec is None or not spec.accepts_broadcast(message):
                return []
        return self._server.receive(received, now)

    def _handle_cancel(self, received: Received, message: m.CommandCancel, now: float) -> list[Outgoing]:
        return self._server.receive(received, now)

    def _handle_timesync(self, received: Received, message: m.Timesync | m.Ping, now: float) -> list[Outgoing]:
        return timesync.handle_request(received, now, self._ids)
