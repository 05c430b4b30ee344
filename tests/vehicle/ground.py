"""The smallest ground station on a real socket, and the vehicle as a real process: for tests of the vehicle alone."""

from __future__ import annotations

import contextlib
import os
import select
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import TracebackType
from typing import Self

from dialects import codec, rover
from dialects.axes import Axes, build_manual_control
from dialects.enums import Autopilot, Command, ModeFlag, VehicleType
from dialects.messages import CommandLong, Heartbeat, Message, StatusText, decode_text
from dialects.modes import Mode
from tests.waits import PATIENCE

PATIENT_LOOP = "FS_LOOP_TIMEOUT=2"
"""A control cycle later than this disarms: the longest that can be set, because the machine is shared."""
DEMAND_PERIOD = 0.05
"""s; the 20 Hz of a ground station that drives."""
TRY = 5.0
"""s for a demand to turn the wheels."""


class Ground:
    """System 255: sends a HEARTBEAT and its demand while it waits, and keeps what it hears."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._parser = rover.MAVLink(None)
        self._vehicle: tuple[str, int] | None = None
        self._sequence = 0
        self.demand: Axes | None = None
        self.heard: list[Message] = []

    @property
    def endpoint(self) -> str:
        """Where the vehicle finds us."""
        return f"udpout:127.0.0.1:{self._socket.getsockname()[1]}"

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self._socket.close()

    def wait(self, condition: Callable[[], bool], what: str, within: float = PATIENCE) -> None:
        """Keep talking and listening until `condition`."""
        deadline = time.monotonic() + within
        while not condition():
            assert time.monotonic() < deadline, f"not within {within} s: {what}; the vehicle said {self.texts()}"
            self._talk()
            self._listen(DEMAND_PERIOD)

    def arm(self) -> None:
        """Take control and arm, with a neutral demand."""
        self.demand = Axes()
        self.wait(lambda: self._vehicle is not None, "a first datagram of the vehicle")
        self._talk()

        def armed() -> bool:
            self.say(CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0))
            return self.armed

        self.wait(armed, "the vehicle arms")

    def drain(self) -> None:
        """Take what has arrived."""
        while self._listen(0.0):
            continue

    @property
    def armed(self) -> bool:
        """What the newest HEARTBEAT says."""
        beats = [message for message in self.heard if isinstance(message, Heartbeat)]
        return bool(beats) and bool(beats[-1].base_mode & ModeFlag.ARMED)

    def texts(self) -> list[str]:
        """What the vehicle has said."""
        return [decode_text(message) for message in self.heard if isinstance(message, StatusText)]

    def _talk(self) -> None:
        self.say(Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, 4, 3))
        if self.demand is not None:
            self.say(build_manual_control(self.demand, 1))

    def say(self, message: Message) -> None:
        """Send it, once the vehicle has shown where it is."""
        if self._vehicle is None:
            return
        data = codec.frame(type(message).id, codec.encode_payload(message), self._sequence, 255, 190)
        self._sequence = (self._sequence + 1) % 256
        with contextlib.suppress(ConnectionRefusedError):
            self._socket.sendto(data, self._vehicle)

    def _listen(self, seconds: float) -> bool:
        ready, _, _ = select.select([self._socket], [], [], seconds)
        if ready:
            data, self._vehicle = self._socket.recvfrom(2048)
            self.heard += self._parser.parse_buffer(data) or []
        return bool(ready)


class Vehicle:
    """`python -m vehicle` with a motor log, until `ended`."""

    def __init__(self, folder: Path, *words: str) -> None:
        self._motor_log = folder / "motors.log"
        patient = ["--param", PATIENT_LOOP, "--motor-log", str(self._motor_log)]
        command = [sys.executable, "-m", "vehicle", *words, *patient]
        environment = {**os.environ, "XDG_STATE_HOME": str(folder)}  # parameters that you have set are not the tests'
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment)

    def ready(self) -> str:
        """The line that says so."""
        assert self.process.stderr is not None
        return self.process.stderr.readline().rstrip()

    def ended(self) -> tuple[int, list[str]]:
        """Wait for its end: exit code, and what it said since the last line read."""
        _, errors = self.process.communicate(timeout=PATIENCE)
        return self.process.returncode, errors.splitlines()

    def outputs(self) -> list[tuple[float, ...]]:
        """Every change of the motors so far."""
        if not self._motor_log.exists():
            return []
        whole = self._motor_log.read_text().rpartition("\n")[0]
        return [tuple(map(float, line.split()[1:])) for line in whole.splitlines()]

    def turning(self) -> bool:
        """Do the wheels turn now?"""
        outputs = self.outputs()
        return bool(outputs) and any(outputs[-1])


@contextlib.contextmanager
def running(folder: Path, *words: str) -> Iterator[Vehicle]:
    """A vehicle that a failing test does not leave behind."""
    vehicle = Vehicle(folder, *words)
    try:
        yield vehicle
    finally:
        if vehicle.process.poll() is None:
            vehicle.process.kill()
        vehicle.process.communicate(timeout=PATIENCE)


def drive(ground: Ground, vehicle: Vehicle) -> None:
    """Arm and go ahead until the wheels turn: every stop test starts from here.

    What a failsafe has ended meanwhile on a late machine is begun anew, as a driver does.
    """
    deadline = time.monotonic() + PATIENCE
    while True:
        ground.arm()
        ground.demand = Axes(throttle=0.5)
        with contextlib.suppress(AssertionError):
            ground.wait(vehicle.turning, "the wheels turn", TRY)
            return
        assert time.monotonic() < deadline, f"the wheels do not turn; the vehicle said {ground.texts()}"
        ground.say(CommandLong(1, 1, Command.DO_SET_MODE, 0, ModeFlag.CUSTOM, Mode.MANUAL, 0, 0, 0, 0, 0))
