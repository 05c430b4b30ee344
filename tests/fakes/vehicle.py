"""The one stand-in for a vehicle: scriptable, in virtual time or on a real line.

A FakeVehicle is a core (link/core.py). It sends heartbeats, answers commands, obeys those it accepts, and records what
it receives. Behaviour is data, so that a test changes it in one line:

    vehicle = FakeVehicle(autopilot=Autopilot.PX4)
    vehicle.answers[Command.COMPONENT_ARM_DISARM] = Result.FAILED, "PreArm: no compass"   # with a STATUSTEXT
    vehicle.answers[Command.SET_MESSAGE_INTERVAL] = lambda command: Result.DENIED if command.param1 == 33 else None
    vehicle.silent_on.add(Command.DO_SET_MODE)            # no answer at all
    vehicle.obeys = False                                 # accepts, and does nothing
    vehicle.on_command[Command.NAV_RETURN_TO_LAUNCH] = lambda: vehicle.change_mode(11)
    vehicle.params["FS_ACTION"] = Param(2, INT32)         # or a plain number
    vehicle.send(m.StatusText(4, b"hello"))

Where it runs:

    Cockpit(vehicle), World(station, vehicle)             # in memory, in virtual time (tests/world.py)
    with on_line(vehicle, "serial"):                      # udpin udpout tcpin tcpout serial, in a thread (lines.py)
        start_a_program(vehicle.endpoint)
    with on_line(vehicle, wire=PymavlinkWire()): ...      # framed by pymavlink: keys, MAVLink 1 (wires.py)

What has arrived: `of("MANUAL_CONTROL")`, `all(m.ManualControl)` with times, `commands(Command.X)`, `wait_for(name, n)`.

More behaviour is a Part, an object with `receive` and `tick` that is given to the constructor: parameters (params.py),
missions, logs, files, modes (services.py), servers of link/services (served.py). FakeArduPilot (rover.py) drives and
sends telemetry as ArduRover 4.7 does; ForeignVehicle (services.py) has all services as ArduPilot or PX4 has them, and
`with foreign_vehicle(PX4) as vehicle` puts it on UDP. A vehicle with physics or a camera is a FakeVehicle with one more
part; two components are two FakeVehicles with the same `system`.

Other classes around a vehicle are no stand-ins for one:

- `CommandRig`, `ParamRig`, `FtpRig`, `MissionRig` (tests/link/*_rig.py), `JobRig`, `LogRig` and `FolderRig` (in their
  tests) hold the real server under test and record its calls. A FakeVehicle would take the server's place.
- `Vehicle` of tests/e2e/programs.py and tests/vehicle/ground.py starts `python -m vehicle` as a process;
  `Vehicle` of tests/interop/test_mavsdk_vehicle.py starts MAVSDK as one; `VehicleMember` of tests/soak kills the first.
- `Vehicle` of tests/benchmarks/bridge_stations.py sends ready frames, because building them would be measured, too;
  `VehicleInMemory` of tests/benchmarks/receive_path.py is the real one without its loop.
- `MuteVehicle` and `Vehicles` of the mavhelm tests are FakeVehicles.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Protocol, TypeVar

from dialects import messages as m
from dialects.enums import Autopilot, Command, ModeFlag, Result, SystemState, VehicleType
from dialects.messages import boot_ms
from dialects.modes import Mode, base_mode
from link.core import LinkReport, Outgoing, Received
from tests.fakes.params import Params
from tests.waits import PATIENCE

MessageT = TypeVar("MessageT", bound=m.Message)
AnyCommand = m.CommandLong | m.CommandInt
Answer = int | tuple[int, str]
"""MAV_RESULT of a command, and the STATUSTEXT before it."""
PX4_MANUAL = 1 << 16
"""Main mode 1 of custom_mode."""


class Part(Protocol):
    """More behaviour of a vehicle."""

    def receive(self, vehicle: FakeVehicle, received: Received, now: float) -> None:
        """Answer a message by `vehicle.send`."""

    def tick(self, vehicle: FakeVehicle, now: float) -> None:
        """Send what is due."""


QUERIES = (Command.REQUEST_MESSAGE, Command.SET_MESSAGE_INTERVAL)
"""Commands that change nothing in the HEARTBEAT."""


class FakeVehicle:
    """A core that answers commands with `answers` and obeys those it accepts.

    `driver`: system in control, 0 for none, None without CONTROL_STATUS. Only one of mavhelm (autopilot GENERIC) has
    one. `mode`: custom_mode.
    """

    def __init__(
        self,
        *,
        autopilot: int = Autopilot.GENERIC,
        driver: int | None = 0,
        mode: int | None = None,
        system: int = 1,
        component: int = 1,
        parts: Iterable[Part] = (),
    ) -> None:
        self.system, self.component = system, component
        self.autopilot = autopilot
        self.kind: int = VehicleType.GROUND_ROVER
        """MAV_TYPE."""
        self.driver = driver if autopilot == Autopilot.GENERIC else None
        self.mode: int = mode if mode is not None else PX4_MANUAL if autopilot == Autopilot.PX4 else Mode.MANUAL
        self.armed = False
        self.locked = False
        self.ready = True
        """Its checks pass; else it says UNINIT as PX4 does."""
        self.calibrating = False
        """The HEARTBEAT says CALIBRATING."""
        self.deaf = False
        """Nothing arrives."""
        self.cut = False
        """Nothing arrives and nothing leaves."""
        self.beats = True
        self.beat_period = 1.0
        """s between two heartbeats."""
        self.obeys = True
        """Does what it accepts."""
        self.silent: set[int] = set()
        """Ids of messages that it does not answer."""
        self.silent_on: set[int] = set()
        """Commands that it does not answer."""
        self.answers: dict[int, Answer | Callable[[AnyCommand], Answer | None]] = {}
        """Command -> its answer, or what chooses it; ACCEPTED (None) is the answer to all others."""
        self.on_command: dict[int, Callable[[], None]] = {}
        """Command -> what happens behind the COMMAND_ACK."""
        self.telemetry: dict[int, Any] = {}
        """Message id -> what REQUEST_MESSAGE brings."""
        self.params = Params()
        self.parts: list[Part] = [self.params, *parts]
        self.received: list[tuple[float, m.Message]] = []
        self.senders: list[tuple[int, int]] = []
        """System and component of each sender, as in `received`."""
        self.endpoint = ""
        """Where a program finds it, if it is on a line."""
        self.outbox: deque[Outgoing] = deque()
        self._beat_due = 0.0
        self._arrived = threading.Condition()

    # ---- core ----

    def receive(self, received: Received, now: float) -> None:
        """Record the message, and answer commands and requests; ignore messages to other vehicles."""
        message = received.message
        if self.deaf or self.cut or m.target_system(message) not in (0, self.system):
            return
        with self._arrived:
            self.received.append((now, message))
            self.senders.append((received.system, received.component))
            self._arrived.notify_all()
        if type(message).id in self.silent:
            return
        match message:
            case m.CommandLong() | m.CommandInt():
                self._command(message, received)
            case m.Timesync() if message.tc1 == 0:
                self.send(m.Timesync(tc1=max(1, int(now * 1e9)), ts1=message.ts1))
            case m.ManualControl() if self.autopilot == Autopilot.GENERIC and self.driver == received.system:
                self.send(self.drive_status(message, received, now))
        for part in self.parts:
            part.receive(self, received, now)

    def tick(self, now: float) -> None:
        """Send one heartbeat in `beat_period`, and what the parts have."""
        if now >= self._beat_due:
            self._beat_due = now + self.beat_period
            self.beat()
        for part in self.parts:
            part.tick(self, now)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Ignore the reports."""

    def messages_to_send(self) -> list[Outgoing]:
        """Return the queued messages. Other threads may queue more at the same time."""
        outbox = [self.outbox.popleft() for _ in range(len(self.outbox))]
        return [] if self.cut else outbox

    # ---- what a test does with it ----

    def send(self, message: Any) -> None:
        """Queue a message; a class of pymavlink works on any wire, too."""
        self.outbox.append(Outgoing(message))

    def say(self, text: str, severity: int = 4) -> None:
        """Send a STATUSTEXT."""
        self.send(m.StatusText(severity, text.encode()))

    def beat(self) -> None:
        """HEARTBEAT, and CONTROL_STATUS unless `driver` is None."""
        if not self.beats:
            return
        status = SystemState.EMERGENCY if self.locked else SystemState.ACTIVE if self.armed else SystemState.STANDBY
        status = SystemState.CALIBRATING if self.calibrating else status
        status = status if self.ready or self.armed else SystemState.UNINIT
        self.send(m.Heartbeat(self.kind, self.autopilot, self._flags(), self.mode, status, 3))
        if self.driver is not None:
            self.send(m.ControlStatus(1, self.driver, [0] * 10))

    def change_mode(self, mode: int, *, armed: bool = True) -> None:
        """Change the mode; the next heartbeat follows at once."""
        self.mode, self.armed, self._beat_due = mode, armed, 0.0

    def drive_status(self, message: m.ManualControl, received: Received, now: float) -> m.RoverDriveStatus:
        """Build the report that this demand is applied."""
        return m.RoverDriveStatus(
            boot_ms(now), 0, message.x * 10, message.r * 10, [message.x * 10, 0, 0, 0], 0,
            received.system, received.sequence,
        )  # fmt: skip

    # ---- what has arrived ----

    @property
    def messages(self) -> list[Any]:
        """What has arrived, without the times."""
        return [message for _, message in list(self.received)]

    def of(self, name: str) -> list[Any]:
        """Return the received messages of this name, such as "MANUAL_CONTROL"."""
        return [message for message in self.messages if message.get_type() == name]

    def all(self, kind: type[MessageT]) -> list[tuple[float, MessageT]]:
        """Return all received messages of a kind, with their times."""
        return [(at, message) for at, message in list(self.received) if isinstance(message, kind)]

    def commands(self, command: int) -> list[m.CommandLong]:
        """Return all received COMMAND_LONG with this command."""
        return [message for _, message in self.all(m.CommandLong) if message.command == command]

    def demands(self, since: float = 0.0) -> list[tuple[float, int]]:
        """Return time and x of the MANUAL_CONTROL received."""
        return [(at, message.x) for at, message in self.all(m.ManualControl) if at >= since]

    def wait_for(self, name: str, count: int, within: float = PATIENCE) -> None:
        """Wait until `count` messages of this name have arrived. Only on a line."""
        with self._arrived:
            assert self._arrived.wait_for(lambda: len(self.of(name)) >= count, within), f"no {count} {name}"

    # ---- commands ----

    def _flags(self) -> int:
        if self.autopilot == Autopilot.PX4:
            return ModeFlag.CUSTOM | (ModeFlag.ARMED if self.armed else 0)
        known = self.mode in Mode._value2member_map_
        return base_mode(Mode(self.mode) if known else Mode.HOLD, armed=self.armed)

    def _command(self, message: AnyCommand, received: Received) -> None:
        command = message.command
        if command in self.silent_on:
            return
        chosen = self.answers.get(command)
        answer = chosen(message) if callable(chosen) else chosen
        result, text = answer if isinstance(answer, tuple) else (answer or Result.ACCEPTED, "")
        if text:
            self.say(text)
        self.send(m.CommandAck(command, result, 0, 0, received.system, received.component))
        if result != Result.ACCEPTED:
            return
        if self.obeys and self._obey(message, received.system):
            self.beat()
        if command == Command.REQUEST_MESSAGE and int(message.param1) in self.telemetry:
            self.send(self.telemetry[int(message.param1)])
        self.on_command.get(command, lambda: None)()

    def _obey(self, message: AnyCommand, source: int) -> bool:
        """Return whether the HEARTBEAT may show it."""
        match message.command:
            case Command.COMPONENT_ARM_DISARM:
                self.armed = message.param1 == 1
                if self.armed and self.driver == 0:
                    self.driver = source
            case Command.DO_SET_MODE:
                main, sub = int(message.param2), int(message.param3)
                self.mode = sub << 24 | main << 16 if self.autopilot == Autopilot.PX4 else main
            case Command.DO_SET_SAFETY_SWITCH_STATE:
                self.locked = message.param1 == 0
                self.armed = self.armed and not self.locked
            case Command.REQUEST_OPERATOR_CONTROL if self.driver is not None:
                self.driver = source if message.param1 == 1 else 0
            case _:
                return False
        return True
