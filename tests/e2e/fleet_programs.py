"""A fleet with real certificates: the router and a vehicle as processes, ground stations as programs of a test."""

from __future__ import annotations

import asyncio
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Hashable, Sequence
from contextlib import ExitStack
from pathlib import Path

from dialects import codec
from dialects import messages as m
from link.bridge.fleet.members import add_member, new_fleet
from link.endpoint import Side
from link.fleet.config import THREADS_VARIABLE
from link.fleet.transport import FleetTransport
from link.protocol.frame import payload_of
from link.protocol.framer import Framer
from link.transport.transports import open_transports
from tests.e2e.programs import PATIENT_LOOP, Vehicle
from tests.ports import free_port
from tests.waits import PATIENCE, Patience

STEP = 0.02


LOCALHOST = ("127.0.0.1",)


def make_fleet(folder: Path, hosts: Sequence[str] = LOCALHOST, *, quic: bool = False, **roles: str) -> Path:
    """Make a fleet with its members, name=role; return its folder. `hosts`: addresses of its routers."""
    path = new_fleet(folder / "farm", "farm", hosts, free_port())
    if quic:
        path.write_text(re.sub(r'"tls/([^"]*)"', r'"quic/\1?mixed_rel=1"', path.read_text()))
    for name, role in roles.items():
        add_member(path, name, role)
    return path.parent


class RouterProcess:
    """`mavhelm bridge router`, which can be frozen, killed and started again."""

    def __init__(self, fleet: Path, stack: ExitStack, *, within: Sequence[str] = (), link: str = "") -> None:
        """`within`: the command that runs it in a network namespace; `link`: the locator of another router."""
        self._fleet = fleet
        self._within, self._link = within, ("--link", link) if link else ()
        self.log = fleet / f"{'-'.join(within) or 'router'}.log"
        self.start()
        stack.callback(self.kill)

    def start(self) -> None:
        """Start it, and wait until it listens."""
        with self.log.open("wb") as log:
            python = (*self._within, sys.executable)
            command = [*python, "-m", "link.bridge", "router", str(self._fleet / "fleet.toml"), *self._link]
            environment = {name: value for name, value in os.environ.items() if name != THREADS_VARIABLE}  # of an end
            self.process = subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL, env=environment)
        patience = Patience(PATIENCE, self.process.pid)
        while "ready" not in self.log.read_text():
            assert not patience.ended, self.log.read_text()
            assert self.process.poll() is None, self.log.read_text()
            time.sleep(STEP)

    def freeze(self) -> None:
        self.process.send_signal(signal.SIGSTOP)

    def thaw(self) -> None:
        self.process.send_signal(signal.SIGCONT)

    def kill(self) -> None:
        self.process.kill()
        self.process.wait(PATIENCE)

    def restore(self) -> None:
        """Let it run again, if a test has stopped or killed it and failed."""
        if self.process.poll() is None:
            self.thaw()
        else:
            self.start()


class FleetWires:
    """A vehicle process in a fleet, and a transport for each operator, as tests/vehicle/wires.py has addresses."""

    def __init__(
        self, folder: Path, fleet: Path, stack: ExitStack, vehicle: str = "rover1", *, within: Sequence[str] = ()
    ) -> None:
        self._fleet, self._name = fleet, vehicle
        endpoint = f"zenoh:{fleet}/{vehicle}.json5/farm/{vehicle}"
        self.vehicle = Vehicle(folder, endpoint, "--param", PATIENT_LOOP, within=within)
        stack.callback(self.vehicle.end)
        self.sent: list[tuple[Hashable, m.Message]] = []
        """Operator -> what the vehicle has sent there."""
        self.boot_ms: tuple[float, int] | None = None
        """Newest time of the vehicle, and when it came."""
        self.longest_silence = 0.0
        """s between two frames of the vehicle, to any operator; set it to 0 to measure from then on."""
        self.met: set[Hashable] = set()
        """Operators to whom the vehicle is new: it has come, or come back."""
        self._heard_at = time.monotonic()
        self._loop = asyncio.new_event_loop()
        stack.callback(self._loop.close)
        self._stack = stack
        self._transports: dict[Hashable, FleetTransport] = {}
        self._framer = Framer(stream=False)

    @property
    def now(self) -> float:
        return time.monotonic()

    def put(self, data: bytes, address: Hashable, link: int = 0, delay: float = 0.0) -> None:
        """Send a frame as an operator."""
        self.transport(address).send(data, self._name)

    def wait(self, seconds: float, each: Callable[[float], None] | None = None) -> None:
        """Let programs speak for a while: `each` is called every 20 ms."""
        end = self.now + seconds
        while (now := self.now) < end:
            if each:
                each(now)
            self._loop.run_until_complete(asyncio.sleep(STEP))

    def until(self, condition: Callable[[], bool], each: Callable[[float], None], within: float = PATIENCE) -> None:
        """Let programs speak until `condition`."""
        patience = Patience(within, self.vehicle.process.pid)
        while not condition():
            assert not patience.ended, self.vehicle.errors.read_text()
            self.wait(STEP, each)

    def transport(self, operator: Hashable) -> FleetTransport:
        """Return the transport of an operator, opened on first use."""
        if operator not in self._transports:
            text = f"zenoh:{self._fleet}/{operator}.json5/farm"
            [opened] = open_transports([text], Side.GROUND_STATION)
            assert isinstance(opened, FleetTransport)
            opened.start(self._loop, lambda pieces: self._take(operator, pieces), lambda _: None)
            self._stack.callback(opened.close)
            self._transports[operator] = opened
        return self._transports[operator]

    def _take(self, operator: Hashable, pieces: Sequence[tuple[bytes, Hashable]]) -> None:
        self.longest_silence = max(self.longest_silence, self.now - self._heard_at)
        self._heard_at = self.now
        for data, _ in pieces:
            if not data:
                self.met.add(operator)
            for number, _, _, _, raw in self._framer.feed(data, self.now):
                message = codec.decode(number, payload_of(raw))
                self.sent.append((operator, message))
                if isinstance(message, m.RoverDriveStatus):
                    self.boot_ms = (self.now, message.time_boot_ms)
