"""Vehicles in motion, each with something in the way of a stop, and the ways to press one with the real programs.

A stand-in gets a demand of its own for ever, so that it moves until it is stopped. Its ground truth is FakeArduPilot's:
it moves while it is armed, in MANUAL and driven.
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Protocol

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import Autopilot, Command, Result
from dialects.modes import Mode
from groundstation.station_socket.connect import running_stations
from link.core import Peer, Received
from tests.e2e.test_identity import SocketWires
from tests.fakes.lines import on_line
from tests.fakes.rover import FakeArduPilot
from tests.fakes.vehicle import AnyCommand, FakeVehicle
from tests.vehicle.wires import Program
from tests.waits import PATIENCE, Waits, wait_until

AHEAD, NEUTRAL = Axes(throttle=1.0), Axes()
ONBOARD_CONTROLLER = 18
"""MAV_TYPE."""
DRIVER = 250
"""System id of the program that drives the vehicles."""
START = 2.0
"""s of CPU for Python and the program to start."""
STOPS_WITHIN = 1.0
NOISE = 0.4
STRANGERS = 40
BEAT_PERIOD = 2.0


class Row(Protocol):
    """A vehicle that moves, and what is in the way."""

    endpoints: list[str]

    def drive(self) -> None:
        """Let the wheels turn, and see that they do."""

    def turning(self) -> bool:
        """Return whether the wheels turn now."""

    def stopped_at(self) -> float:
        """Return when they stopped."""

    def step(self) -> None:
        """Let a little time pass, with all that is in the way going on."""


class Demand:
    """A part: the demand of a driver, which does not end."""

    def receive(self, vehicle: FakeVehicle, received: Received, now: float) -> None:
        """Ignore what arrives."""

    def tick(self, vehicle: FakeVehicle, now: float) -> None:
        """Bring the demand."""
        demand = m.ManualControl(1, 0, 0, 800, 0, 0)
        vehicle.receive(Received(demand, DRIVER, 190, 0, Peer(0, "driver"), introduced=True), now)


class Rover(FakeArduPilot):
    """An ArduRover that is driven by somebody else. `int_only`: it takes no COMMAND_LONG."""

    def __init__(self, component: int = 1, *, int_only: bool = False) -> None:
        super().__init__(station=DRIVER, mode=Mode.MANUAL)
        self.component, self._int_only = component, int_only
        self.parts.append(Demand())

    def hold_on(self) -> None:
        """Go on with the demand though nothing arrives, also beyond the 3 s after which it would end."""
        self._demand_at = time.monotonic()

    def _command(self, message: AnyCommand, received: Received) -> None:
        if self._int_only and isinstance(message, m.CommandLong):
            ids = received.system, received.component
            self.send(m.CommandAck(message.command, Result.INT_ONLY, 0, 0, *ids))
        else:
            super()._command(message, received)


class Stands:
    """Rovers without our program, each on a line of its own."""

    def __init__(
        self, stack: ExitStack, *rovers: Rover, first: FakeVehicle | None = None, line: str = "udpout"
    ) -> None:
        """`first`: what is heard before the rovers."""
        self.rovers = rovers
        self._first = first
        everybody: list[FakeVehicle] = [*([first] if first else []), *rovers]
        for each in everybody:
            stack.enter_context(on_line(each, line))
        self.endpoints = [each.endpoint for each in everybody]

    def drive(self) -> None:
        """Arm them by hand."""
        for each in self.rovers:
            each.beats = self._first is None
            each.change_mode(Mode.MANUAL)
            Demand().tick(each, time.monotonic())  # a line does nothing before a program speaks
        wait_until(lambda: all(each.moves for each in self.rovers), "the wheels turn")

    def turning(self) -> bool:
        """Return whether any of them moves."""
        return any(each.moves for each in self.rovers)

    def stopped_at(self) -> float:
        """Return when the last of them stopped."""
        return max(each.stopped_at for each in self.rovers)

    def step(self) -> None:
        """Let the rovers be heard once the first one was greeted."""
        if self._first is not None and self._first.of("HEARTBEAT"):
            for each in self.rovers:
                each.beats = True
        time.sleep(0.005)


class Crowd:
    """Our rover, driven by one of the strangers that hold all places of its link."""

    def __init__(self, stack: ExitStack, folder: Path) -> None:
        self.wires = SocketWires(folder, stack)
        self.endpoints = [f"udpout:127.0.0.1:{self.wires.ports[0]}"]
        self._driver = Program(self.wires, "driver", ids=(DRIVER, 190))  # type: ignore[arg-type]
        self._strangers: list[Program] = []
        """They come once the driver has a place."""
        self._beat_due = 0.0

    def drive(self) -> None:
        """Fill the places, release what the stop before has locked, arm, drive."""
        begun = time.monotonic()
        self._until(lambda: bool(self.wires.sent))
        self._strangers = self._strangers or [self._stranger(number) for number in range(STRANGERS)]
        while not self.turning():
            assert time.monotonic() < begun + PATIENCE, self.wires.vehicle.errors.read_text()
            self._for(0.2)
            self._driver.command(Command.DO_SET_SAFETY_SWITCH_STATE, 1)
            self._driver.set_mode(Mode.MANUAL)
            self._driver.arm()
            self._for(0.2)
            self._for(1.0, AHEAD)

    def turning(self) -> bool:
        """Return whether the wheels turn."""
        return self.wires.vehicle.turning()

    def stopped_at(self) -> float:
        """Return when they stopped."""
        return self.wires.vehicle.outputs()[-1].at

    def step(self) -> None:
        """Drive on, and keep the places."""
        self._step(AHEAD)
        self.wires.wait(0.02)

    def _stranger(self, number: int) -> Program:
        return Program(self.wires, f"stranger {number}", ids=(100 + number, 190))  # type: ignore[arg-type]

    def _step(self, axes: Axes) -> None:
        self._driver.step(axes)
        if time.monotonic() >= self._beat_due:
            self._beat_due = time.monotonic() + BEAT_PERIOD
            for each in self._strangers:
                each.beat()

    def _for(self, seconds: float, axes: Axes = NEUTRAL) -> None:
        until = time.monotonic() + seconds
        self._until(lambda: time.monotonic() > until or (axes is AHEAD and self.turning()), axes)

    def _until(self, condition: Callable[[], bool], axes: Axes = NEUTRAL) -> None:
        self.wires.until(condition, lambda now: self._step(axes))


def companion() -> FakeVehicle:
    """A computer on board that claims an autopilot of its own and answers nothing."""
    made = FakeVehicle(autopilot=Autopilot.GENERIC, driver=None, component=191)
    made.kind = ONBOARD_CONTROLLER
    made.silent |= {m.CommandLong.id, m.CommandInt.id}
    return made


def start(stack: ExitStack, module: str, *arguments: str) -> subprocess.Popen[bytes]:
    """Start a program that is killed in the end."""
    command = [sys.executable, "-m", module, *arguments]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    stack.callback(process.wait, PATIENCE)
    stack.callback(process.kill)
    return process


class Station:
    """A station without a screen."""

    def __init__(self, stack: ExitStack, endpoints: Sequence[str]) -> None:
        self.process = start(stack, "groundstation", "serve", "--headless", *endpoints)
        wait_until(lambda: self.process.pid in running_stations(), "the station runs")


class Pressed:
    """A verb as a program of its own."""

    def __init__(self, name: str, *options: str) -> None:
        """Start `mavhelm name options`."""
        self.began = time.monotonic()
        command = [sys.executable, "-m", "groundstation", name, *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.waits = Waits(self.process.pid)

    def stops(self, row: Row, *, later: float = 0.0) -> str:
        """Wait until the wheels stand and the verb has ended with 0; check when. Return what it has said."""
        deadline = self.began + PATIENCE
        while row.turning():
            assert time.monotonic() < deadline, f"still turning\n{self._end()}"
            row.step()
            self.waits.total()
        took, waited = row.stopped_at() - self.began, self.waits.total()
        while self.process.poll() is None:
            assert time.monotonic() < deadline, self._end()
            row.step()
        said = self._end()
        assert not row.turning()
        assert self.process.returncode == 0, said
        assert took <= START + STOPS_WITHIN + later + NOISE + waited, (took, waited, said)
        return said

    def read_line(self) -> str:
        """Return the next line that it says."""
        assert self.process.stderr is not None
        return self.process.stderr.readline()

    def _end(self) -> str:
        if self.process.poll() is None:
            self.process.kill()
        return self.process.communicate()[1]
