"""What the rover answers: commands, setpoints, parameters, plans, files, logs, time. Demands are vehicle/rover.py's.

It joins those who know, each with a file of its own, and decides nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from dialects import messages as m
from link.core import Outgoing, Received
from link.services import timesync
from link.services.command.server import CommandServer
from vehicle.accessories.accessory_set import AccessorySet
from vehicle.autonomy.navigator import Navigator
from vehicle.commands.accessories import AccessoryCommands
from vehicle.commands.actuator_test import ActuatorTest
from vehicle.commands.arming import ArmingCommands
from vehicle.commands.files import FileServices
from vehicle.commands.guided import GuidedCommands
from vehicle.commands.mission import MissionService
from vehicle.commands.origin import OriginCommands
from vehicle.commands.params import ParamService
from vehicle.commands.preflight import PreflightCommands
from vehicle.commands.reboot import RebootRequest
from vehicle.commands.requests import MessageRequests
from vehicle.drive.control import Control
from vehicle.drive.drive import Drive
from vehicle.params import Params
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue
from vehicle.storage.logbook import Logbook, LogRecorder
from vehicle.storage.param_store import ParamStore
from vehicle.storage.plan_store import PlanStore
from vehicle.telemetry.bandwidth import Bandwidth
from vehicle.telemetry.link_status import LinkStatusReporter
from vehicle.telemetry.telemetry import Telemetry
from vehicle.telemetry.view import TelemetryView

COMPONENT = 1
"""MAV_COMP_ID_AUTOPILOT1: QGroundControl makes a vehicle only of this one."""


class Stores(NamedTuple):
    """What outlives the program; without them it ends with it."""

    params: ParamStore | None = None
    plans: PlanStore | None = None
    logs: LogRecorder | None = None


class Dispatcher:
    """`order` for what may move the rover, `receive` for the rest, `tick` for what is under way."""

    def __init__(
        self,
        params: Params,
        safety: Safety,
        control: Control,
        navigator: Navigator,
        drive: Drive,
        texts: StatusTextQueue,
        *,
        telemetry: Telemetry,
        bandwidth: Bandwidth,
        links: LinkStatusReporter,
        trials: ActuatorTest,
        stores: Stores,
        rack: AccessorySet,
        look: Callable[[float], TelemetryView],
    ) -> None:
        """`rack` holds the accessories; `look` is the rover at a moment."""
        self._safety = safety
        self._navigator = navigator
        self._system = control.system
        self._ids = (control.system, COMPONENT)
        pacer = bandwidth.pacer
        self._params = ParamService(
            params, control, texts, ids=self._ids, pacer=pacer, armed=lambda: safety.armed, store=stores.params
        )
        self._commands = ArmingCommands(safety, control, texts)
        self._orders = GuidedCommands(params, safety, control, navigator, texts)
        self._origin = OriginCommands(safety, control, navigator, texts, look)
        motors = drive.mixer.servos
        self._accessories = AccessoryCommands(rack, safety, control, texts, motors)
        self._plans = MissionService(
            safety, control, navigator, texts, motors, self._accessories, pacer=pacer, store=stores.plans
        )
        self.logbook = Logbook(params, control, texts, lambda: safety.armed, stores.logs)
        self._services = FileServices(
            params, control, self.logbook, missions=self._plans.folder(), ids=self._ids, pacer=pacer
        )
        self._preflight = PreflightCommands(params, safety, control, navigator, self._params, self._plans, texts)
        self._requests = MessageRequests(telemetry, look, self._services.message_builders(), links)
        tables = (self._commands, self._requests, self._orders, self._origin, self._plans, self._accessories, trials,
                  self._preflight)  # fmt: skip
        handlers = {command: handler for each in tables for command, handler in each.handlers().items()}
        self._server = CommandServer(handlers, system=self._system, component=COMPONENT)

    @property
    def commands(self) -> frozenset[int]:
        """What is answered with more than UNSUPPORTED."""
        return self._server.commands

    def reboot_request(self, now: float) -> RebootRequest | None:
        """How the program is to end because a ground station asked for it, or None."""
        return self._preflight.reboot_request(now)

    def dispatch_command(self, received: Received, now: float) -> list[Outgoing] | None:
        """Take what changes the rover or what it tells, and answer it; None where it is nothing of the kind."""
        answers: list[Outgoing] = []
        match received.message:
            case m.CommandLong() | m.CommandInt() as message:
                answers = self._command(message, received, now)
            case m.CommandCancel():
                answers = self._server.receive(received, now)
            case m.SetPositionTargetLocalNed() | m.SetPositionTargetGlobalInt() | m.SetAttitudeTarget() as message:
                if self._orders.handle_setpoint(received, message, now):
                    self._navigator.step(self._safety, now)
            case m.SetGpsGlobalOrigin(target_system=self._system) as message:
                answers = self._origin.receive(received, message, now)
            case m.SetMode(target_system=self._system) as message:
                self._commands.handle_set_mode(received, message, now)
            case _:
                return None
        self._navigator.restart_mode(self._safety, now)
        return answers

    def dispatch(self, received: Received, now: float) -> list[Outgoing]:
        """Answer what moves nothing."""
        self._preflight.receive(received, now)
        return [
            *timesync.handle_request(received, now, self._ids),
            *self._plans.receive(received, now),
            *self._params.receive(received, now),
            *self._services.receive(received, now),
        ]

    def tick(self, now: float) -> list[Outgoing]:
        """The next of what is under way."""
        outgoing = [
            *self._server.tick(now),
            *self._params.tick(now),
            *self._services.tick(now),
            *self._plans.tick(now),
            *self.logbook.tick(now),
        ]
        self._accessories.update(now)
        return outgoing

    def handle_link_reports(self, now: float) -> None:
        """The links have reported."""
        self._params.observe(now)
        self.logbook.check_health(now)

    def _command(self, message: m.CommandLong | m.CommandInt, received: Received, now: float) -> list[Outgoing]:
        if message.target_system == 0 and not self._commands.accepts_broadcast(message):
            return []
        answers = self._server.receive(received, now)
        for each in (self._commands, self._requests, self._origin):
            answers += each.messages_to_send()
        return answers
