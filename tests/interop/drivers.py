"""Every client behind one interface: it sees the vehicle, holds a stick, and takes or releases control."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any, Protocol

from dialects import messages as m
from dialects.enums import Command, ModeFlag, Result
from tests.interop import mavproxy, mavsdk_process
from tests.interop.conversation import Conversation
from tests.interop.qgroundcontrol import JOYSTICK, QGroundControl
from tests.interop.script import Script
from tests.waits import PATIENCE, Patience

RELEASE, REQUEST = 0, 1
"""Parameter 1 of REQUEST_OPERATOR_CONTROL."""
MANUAL = (Command.DO_SET_MODE, 1.0, 0.0)
NEUTRALS = 6
"""Neutral messages that are sent before the stick moves."""
SIGHTS = ("attitude", "position", "motion")
"""What a client must see: the vehicle, its position and its motion."""


class Driver(Protocol):
    """A client. The vehicle must accept what it does; otherwise AssertionError."""

    system: int

    def arm(self) -> None: ...

    def disarm(self) -> None: ...

    def push(self, throttle: float) -> None:
        """Hold the stick there from now on, -1..1, neutral first; 0 is a stick at rest."""

    def command(self, command: int, *params: float) -> None:
        """Send a COMMAND_LONG that must be accepted."""

    def sees_armed(self, armed: bool) -> None: ...

    def sees(self, sight: str) -> None:
        """Wait for one of SIGHTS, since the start."""

    def reads(self, text: str) -> None:
        """Wait for a STATUSTEXT of the vehicle that matches this pattern, since the start."""


STATUS = {
    "attitude": ("status ATTITUDE", r"ATTITUDE \{.*yaw :"),
    "position": ("status GLOBAL_POSITION_INT", r"GLOBAL_POSITION_INT \{.*lat : -35\d+"),
    "motion": ("status VFR_HUD", r"groundspeed : (0\.[1-9]|[1-9])"),
}
"""What MAVProxy's user types to see something, and what MAVProxy prints then."""


class MavProxyDriver:
    """MAVProxy, by typed commands."""

    def __init__(self, program: Conversation, system: int) -> None:
        self._program = program
        self.system = system

    def arm(self) -> None:
        self._program.ask("arm throttle", r"ARM_DISARM: ACCEPTED", 1.0)

    def disarm(self) -> None:
        self._program.ask("disarm", r"ARM_DISARM: ACCEPTED", 1.0)

    def push(self, throttle: float) -> None:
        self._program.say("rc 3 1500")
        self._program.say(f"rc 3 {1500 + round(throttle * 500)}")

    def command(self, command: int, *params: float) -> None:
        self._program.say(f"long {int(command)} {' '.join(map(str, params))}")
        self._program.hear(f"COMMAND_ACK.*(ACCEPTED|{int(command)}, result : 0,)")

    def sees_armed(self, armed: bool) -> None:
        self._program.wait_for("(?<![A-Z_])ARMED" if armed else "DISARMED")

    def sees(self, sight: str) -> None:
        self._program.ask(*STATUS[sight])

    def reads(self, text: str) -> None:
        self._program.wait_for(text)


class MavsdkDriver:
    """MAVSDK, by orders to a script."""

    def __init__(self, client: mavsdk_process.Client, system: int) -> None:
        self._client = client
        self.system = system

    def _do(self, line: str) -> None:
        self._client.say(line)
        self._client.good(line)

    def arm(self) -> None:
        self._do("arm")

    def disarm(self) -> None:
        self._do("disarm")

    def push(self, throttle: float) -> None:
        self._do(f"push {throttle}")

    def command(self, command: int, *params: float) -> None:
        self._do(f"command {int(command)} {' '.join(map(str, params))}")

    def sees_armed(self, armed: bool) -> None:
        self._client.step("armed", str(armed))

    def sees(self, sight: str) -> None:
        self._client.step(sight)

    def reads(self, text: str) -> None:
        self._client.step("text", text)


class Loop:
    """A client that must be polled: a thread owns it, repeats its stick, and records what arrives."""

    def __init__(self, turn: Callable[[], None], send: Callable[[int], None], system: int) -> None:
        """`turn` receives for a moment, `send` sends a MANUAL_CONTROL with this throttle."""
        self.system = system
        self._turn, self._send = turn, send
        self._jobs: SimpleQueue[Callable[[], None]] = SimpleQueue()
        self._throttle: int | None = None
        self._neutrals = 0
        self._armed: bool | None = None
        self._sights: set[str] = set()
        self._texts: list[str] = []
        self._running = True
        self._thread = threading.Thread(target=self._run, name=f"driver {system}", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop the thread."""
        self._running = False
        self._thread.join(PATIENCE)

    def arm(self) -> None:
        self.command(Command.COMPONENT_ARM_DISARM, 1)

    def disarm(self) -> None:
        self.command(Command.COMPONENT_ARM_DISARM, 0)

    def command(self, command: int, *params: float) -> None:
        raise NotImplementedError

    def push(self, throttle: float) -> None:
        self._neutrals, self._throttle = NEUTRALS, round(throttle * 1000)

    def sees_armed(self, armed: bool) -> None:
        self._wait(lambda: self._armed is armed, f"armed: {armed}")

    def sees(self, sight: str) -> None:
        self._wait(lambda: sight in self._sights, sight)

    def reads(self, text: str) -> None:
        self._wait(lambda: any(re.search(text, each) for each in list(self._texts)), text)

    def note(self, kind: str, message: Any) -> None:
        """Record a message of the vehicle; both codecs have the same field names."""
        if kind == "HEARTBEAT":
            self._armed = bool(message.base_mode & ModeFlag.ARMED)
        elif kind == "ATTITUDE":
            self._sights.add("attitude")
        elif kind == "GLOBAL_POSITION_INT" and message.lat:
            self._sights.add("position")
        elif kind == "VFR_HUD" and message.groundspeed > 0.1:
            self._sights.add("motion")
        elif kind == "STATUSTEXT":
            self._texts.append(message.text if isinstance(message.text, str) else m.decode_text(message))

    def call(self, job: Callable[[], bool], what: str, within: float = PATIENCE) -> None:
        """Let the thread run it, again until it returns true."""
        done = threading.Event()

        def once() -> None:
            if job():
                done.set()
            else:
                self._jobs.put(once)

        self._jobs.put(once)
        assert done.wait(within), f"GCS {self.system}: not done: {what}; {self._texts[-5:]}"

    def _run(self) -> None:
        while self._running:
            with suppress(Empty):
                self._jobs.get_nowait()()
            if self._throttle is not None:
                self._send(0 if self._neutrals else self._throttle)
                self._neutrals = max(0, self._neutrals - 1)
            self._turn()

    def _wait(self, condition: Callable[[], bool], what: str) -> None:
        patience = Patience()
        tick = threading.Event()
        while not condition():
            assert not patience.ended, f"GCS {self.system} never saw {what}; {self._texts[-5:]}"
            tick.wait(0.02)


class ScriptDriver(Loop):
    """pymavlink, by a script."""

    def __init__(self, script: Script, system: int) -> None:
        self._script = script
        script.link.message_hooks.append(self._hook)
        super().__init__(
            lambda: script.listen(JOYSTICK),
            lambda throttle: script.link.mav.manual_control_send(1, throttle, 0, 0, 0, 0),
            system,
        )

    def command(self, command: int, *params: float) -> None:
        self.call(lambda: self._script.command(command, *params) == Result.ACCEPTED, str(command))

    def _hook(self, _: Any, message: Any) -> None:
        if message.get_srcSystem() == 1:
            self.note(message.get_type(), message)


class GroundDriver(Loop):
    """The stand-in for QGroundControl."""

    def __init__(self, ground: QGroundControl, system: int) -> None:
        self._ground = ground
        ground.watch = lambda message: self.note(message.get_type(), message)
        super().__init__(
            lambda: ground.listen(JOYSTICK),
            lambda throttle: ground.send(m.ManualControl(target=1, x=throttle, y=0, z=0, r=0, buttons=0)),
            system,
        )

    def command(self, command: int, *params: float) -> None:
        self.call(lambda: self._ground.command(command, *params) is Result.ACCEPTED, str(command))


@contextmanager
def mavproxy_driver(port: int, system: int, folder: Path) -> Iterator[Driver]:
    with mavproxy.started(port, folder, system) as program:
        program.hear("Received .* parameters")
        yield MavProxyDriver(program, system)


@contextmanager
def mavsdk_driver(port: int, system: int, folder: Path) -> Iterator[Driver]:
    with mavsdk_process.started(port, "wheel", folder, system) as client:
        yield MavsdkDriver(client, system)


@contextmanager
def script_driver(port: int, system: int, folder: Path) -> Iterator[Driver]:
    with Script(port, system) as script, closing(ScriptDriver(script, system)) as driver:
        yield driver


@contextmanager
def ground_driver(port: int, system: int, folder: Path) -> Iterator[Driver]:
    with QGroundControl(port, system) as ground:
        ground.meet()
        with closing(GroundDriver(ground, system)) as driver:
            yield driver


KINDS = {
    "MAVProxy": mavproxy_driver,
    "MAVSDK": mavsdk_driver,
    "pymavlink": script_driver,
    "QGroundControl": ground_driver,
}
"""Name -> how to start a client: port, system id, folder."""
