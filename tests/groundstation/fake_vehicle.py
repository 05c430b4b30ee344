"""A scripted vehicle, and a station with an operator whose screen renews its lease."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from dialects import messages as m
from dialects.enums import Autopilot, Command, ModeFlag, Result, SystemState, VehicleType
from dialects.messages import boot_ms
from dialects.modes import Mode, base_mode
from groundstation.intents.session import REST_PERIOD, RenewLease, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.snapshot import OperatorView, Snapshot, VehicleView
from groundstation.station.crash_neutral import CrashNeutral
from groundstation.station.station import Station
from link.core import LinkReport, Outgoing, Received
from link.transport.memory import LossyPipe
from tests.world import World

OURS = 255
QUERIES = (Command.REQUEST_MESSAGE, Command.SET_MESSAGE_INTERVAL)
"""Commands that change nothing in the HEARTBEAT."""
MessageT = TypeVar("MessageT", bound=m.Message)


class FakeVehicle:
    """A core that answers commands with `answers` and obeys those it accepts."""

    def __init__(
        self,
        *,
        autopilot: int = Autopilot.GENERIC,
        driver: int | None = 0,
        mode: Mode = Mode.MANUAL,
        system: int = 1,
    ) -> None:
        self.system = system
        self.autopilot = autopilot
        self.driver = driver
        self.mode = mode
        self.armed = False
        self.locked = False
        self.silent_on: set[int] = set()
        self.answers: dict[int, Result] = {}
        self.reasons: dict[int, bytes] = {}
        self.parameters: dict[str, float] = {}
        self.received: list[tuple[float, m.Message]] = []
        self.outbox: list[Outgoing] = []
        self._beat_due = 0.0

    def receive(self, received: Received, now: float) -> None:
        """Record the message, and answer commands and requests; ignore messages to other vehicles."""
        message = received.message
        if m.target_system(message) not in (0, self.system):
            return
        self.received.append((now, message))
        match message:
            case m.CommandLong():
                self._command(message, received.system)
            case m.ParamRequestRead() if message.param_id in self.parameters:
                value = self.parameters[message.param_id]
                self.send(m.ParamValue(message.param_id.encode(), value, 9, 1, 0xFFFF))
            case m.Timesync() if message.tc1 == 0:
                self.send(m.Timesync(tc1=1, ts1=message.ts1))
            case m.ManualControl() if self.autopilot == Autopilot.GENERIC and self.driver == received.system:
                self.send(self.drive_status(message, received, now))

    def tick(self, now: float) -> None:
        """Send one heartbeat a second."""
        if now >= self._beat_due:
            self._beat_due = now + 1.0
            self.beat()

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Ignore the reports."""

    def messages_to_send(self) -> list[Outgoing]:
        """Return the queued messages."""
        outbox, self.outbox = self.outbox, []
        return outbox

    def send(self, message: m.Message) -> None:
        """Queue a message."""
        self.outbox.append(Outgoing(message))

    def beat(self) -> None:
        """HEARTBEAT, and CONTROL_STATUS unless `driver` is None."""
        status = SystemState.EMERGENCY if self.locked else SystemState.ACTIVE if self.armed else SystemState.STANDBY
        if self.autopilot == Autopilot.PX4:
            mode, flags = 1 << 16, ModeFlag.CUSTOM | (ModeFlag.ARMED if self.armed else 0)
        else:
            mode, flags = self.mode, base_mode(self.mode, armed=self.armed)
        self.send(m.Heartbeat(VehicleType.GROUND_ROVER, self.autopilot, flags, mode, status, 3))
        if self.driver is not None:
            self.send(m.ControlStatus(1, self.driver, [0] * 10))

    def drive_status(self, message: m.ManualControl, received: Received, now: float) -> m.RoverDriveStatus:
        """Build the report that this demand is applied."""
        return m.RoverDriveStatus(
            boot_ms(now), 0, message.x * 10, message.r * 10, [message.x * 10, 0, 0, 0], 0,
            received.system, received.sequence,
        )  # fmt: skip

    def all(self, kind: type[MessageT]) -> list[tuple[float, MessageT]]:
        """Return all received messages of a kind, with their times."""
        return [(at, message) for at, message in self.received if isinstance(message, kind)]

    def commands(self, command: int) -> list[m.CommandLong]:
        """Return all received COMMAND_LONG with this command."""
        return [message for _, message in self.all(m.CommandLong) if message.command == command]

    def _command(self, message: m.CommandLong, source: int) -> None:
        command = message.command
        if command in self.silent_on:
            return
        result = self.answers.get(command, Result.ACCEPTED)
        if result is Result.ACCEPTED:
            self._obey(message, source)
        elif command in self.reasons:
            self.send(m.StatusText(4, self.reasons[command]))
        self.send(m.CommandAck(command, result, target_system=source, target_component=190))
        if result is Result.ACCEPTED and command not in QUERIES:
            self.beat()

    def _obey(self, message: m.CommandLong, source: int) -> None:
        match message.command:
            case Command.COMPONENT_ARM_DISARM:
                self.armed = message.param1 == 1
                if self.armed and self.driver == 0:
                    self.driver = source
            case Command.DO_SET_MODE:
                self.mode = Mode(int(message.param2))
            case Command.DO_SET_SAFETY_SWITCH_STATE:
                self.locked = message.param1 == 0
                self.armed = self.armed and not self.locked
            case Command.REQUEST_OPERATOR_CONTROL if self.driver is not None:
                self.driver = source if message.param1 == 1 else 0


class Cockpit:
    """A station whose screen renews its lease, connected with a vehicle in virtual time."""

    def __init__(self, vehicle: FakeVehicle | None = None, *, loss: float = 0.0) -> None:
        self.vehicle = vehicle or FakeVehicle()
        self.station = Station(["udpin:127.0.0.1:14550"], session=7, now=100.0)
        self.core = CrashNeutral(self.station)
        up, down = LossyPipe(loss=loss, seed=1), LossyPipe(loss=loss, seed=2)
        self.world = World(self.core, self.vehicle, up=up, down=down)
        self.leasing = True
        self._lease_due = 0.0
        self.do(RenewLease(), SetKeyGate(open=True))

    @property
    def now(self) -> float:
        """s"""
        return self.world.now

    def do(self, *intents: AnyIntent) -> None:
        """Handle intents now."""
        for intent in intents:
            self.station.handle_intent(intent, self.now)
        self.world.settle()

    def run(self, seconds: float) -> None:
        """Advance the time."""
        self.world.run(seconds, self._renew)

    def _renew(self, now: float) -> None:
        period = REST_PERIOD if self.station.rests else 0.1
        self._lease_due = min(self._lease_due, now + period)  # the next snapshot tells of the end of a rest
        if self.leasing and now >= self._lease_due:
            self._lease_due = now + period
            if not self.station.renew_lease(now):
                self.station.handle_intent(RenewLease(), now)

    @property
    def snapshot(self) -> Snapshot:
        """The snapshot now; the wall clock is 1000 s ahead."""
        return self.station.snapshot(self.now, self.now + 1000.0)

    @property
    def view(self) -> VehicleView:
        """The selected vehicle."""
        view = self.snapshot.vehicle
        assert view is not None
        return view

    @property
    def operator(self) -> OperatorView:
        """The operator's part of the snapshot."""
        return self.snapshot.operator

    @property
    def texts(self) -> list[str]:
        """The message log."""
        return [line.text for line in self.snapshot.texts]

    def demands(self, since: float = 0.0) -> list[tuple[float, int, int]]:
        """Return time, x and r of the MANUAL_CONTROL that the vehicle received."""
        return [(at, message.x, message.r) for at, message in self.vehicle.all(m.ManualControl) if at >= since]
