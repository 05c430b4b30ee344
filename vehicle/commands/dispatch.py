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
from vehicle.accessories.accessory_set import Rack
from vehicle.autonomy.navigator import Navigator
from vehicle.commands.accessories import AccessoryOrders
from vehicle.commands.actuator_test import ActuatorTest
from vehicle.commands.arming import Commands
from vehicle.commands.files import Services
from vehicle.commands.guided import Orders
from vehicle.commands.mission import Plans
from vehicle.commands.origin import OriginSetting
from vehicle.commands.params import Keeper, ParamService
from vehicle.commands.preflight import Preflight
from vehicle.commands.reboot import Leave
from vehicle.commands.requests import Requests
from vehicle.drive.control import Control
from vehicle.drive.drive import Drive
from vehicle.params import Params
from vehicle.safety.state_machine import Safety
from vehicle.statustext import Texts
from vehicle.storage.logbook import Logbook, Recording
from vehicle.storage.plan_keeping import PlanKeeper
from vehicle.telemetry.bandwidth import Bandwidth
from vehicle.telemetry.link_status import Links
from vehicle.telemetry.telemetry import Telemetry
from vehicle.telemetry.view import View

COMPONENT = 1
"""MAV_COMP_ID_AUTOPILOT1: QGroundControl makes a vehicle only of this one."""


class Keepers(NamedTuple):
    """What outlives the program; without them it ends with it."""

    params: Keeper | None = None
    plans: PlanKeeper | None = None
    logs: Recording | None = None


class Answers:
    """`order` for what may move the rover, `receive` for the rest, `tick` for what is under way."""

    def __init__(
        self,
        params: Params,
        safety: Safety,
        control: Control,
        navigator: Navigator,
        drive: Drive,
        texts: Texts,
        *,
        telemetry: Telemetry,
        bandwidth: Bandwidth,
        links: Links,
        trials: ActuatorTest,
        keepers: Keepers,
        rack: Rack,
        look: Callable[[float], View],
    ) -> None:
        """`rack` holds the accessories; `look` is the rover at a moment."""
        self._safety = safety
        self._navigator = navigator
        self._system = control.system
        self._ids = (control.system, COMPONENT)
        pacer = bandwidth.pacer
        self._params = ParamService(
            params, control, texts, ids=self._ids, pacer=pacer, armed=lambda: safety.armed, keeper=keepers.params
        )
        self._commands = Commands(safety, control, texts)
        self._orders = Orders(params, safety, control, navigator, texts)
        self._origin = OriginSetting(safety, control, navigator, texts, look)
        motors = drive.mixer.servos
        self._accessories = AccessoryOrders(rack, safety, control, texts, motors)
        self._plans = Plans(
            safety, control, navigator, texts, motors, self._accessories, pacer=pacer, keeper=keepers.plans
        )
        self.logbook = Logbook(params, control, texts, lambda: safety.armed, keepers.logs)
        self._services = Services(
            params, control, self.logbook, missions=self._plans.folder(), ids=self._ids, pacer=pacer
        )
        self._preflight = Preflight(params, safety, control, navigator, self._params, self._plans, texts)
        self._requests = Requests(telemetry, look, self._services.messages(), links)
        tables = (self._commands, self._requests, self._orders, self._origin, self._plans, self._accessories, trials,
                  self._preflight)  # fmt: skip
        handlers = {command: handler for each in tables for command, handler in each.handlers().items()}
        self._server = CommandServer(handlers, system=self._system, component=COMPONENT)

    @property
    def commands(self) -> frozenset[int]:
        """What is answered with more than UNSUPPORTED."""
        return self._server.commands

    def leaving(self, now: float) -> Leave | None:
        """How the program is to end because a ground station asked for it, or None."""
        return self._preflight.leaving(now)

    def order(self, received: Received, now: float) -> list[Outgoing] | None:
        """Take what changes the rover or what it tells, and answer it; None where it is nothing of the kind."""
        answers: list[Outgoing] = []
        match received.message:
            case m.CommandLong() | m.CommandInt() as message:
                answers = self._command(message, received, now)
            case m.CommandCancel():
                answers = self._server.receive(received, now)
            case m.SetPositionTargetLocalNed() | m.SetPositionTargetGlobalInt() | m.SetAttitudeTarget() as message:
                if self._orders.setpoint(received, message, now):
                    self._navigator.step(self._safety, now)
            case m.SetGpsGlobalOrigin(target_system=self._system) as message:
                answers = self._origin.receive(received, message, now)
            case m.SetMode(target_system=self._system) as message:
                self._commands.set_mode(received, message, now)
            case _:
                return None
        self._navigator.renew(self._safety, now)
        return answers

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Answer what moves nothing."""
        self._preflight.receive(received, now)
        return [
            *timesync.answer(received, now, self._ids),
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
        self._accessories.step(now)
        return outgoing

    def observe(self, now: float) -> None:
        """The links have reported."""
        self._params.observe(now)
        self.logbook.observe(now)

    def _command(self, message: m.CommandLong | m.CommandInt, received: Received, now: float) -> list[Outgoing]:
        if message.target_system == 0 and not self._commands.for_everybody(message):
            return []
        answers = self._server.receive(received, now)
        for each in (self._commands, self._requests, self._origin):
            answers += each.messages_to_send()
        return answers
