"""The ground station of a measurement: our own clients for parameters, missions and files on real links, no screen."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from typing import Protocol

from dialects import messages as m
from dialects.enums import Autopilot, Command, ModeFlag, Result, SystemState, VehicleType
from link.core import LinkReport, Outgoing, Received
from link.endpoint import Side
from link.links import open_links
from link.runner import Runner
from link.services.ftp.client import FtpClient
from link.services.mission.client import MissionClient
from link.services.param.client import ParamClient
from tests.benchmarks.figures import BenchmarkError

SYSTEM, COMPONENT = 255, 190
VEHICLE = (1, 1)
HEARTBEAT_PERIOD = 1.0
PERIOD = 0.02
"""s, as the ground station's own loop."""
REPEAT_AFTER = 1.0
"""s without an acknowledgement before a command is repeated."""


class Client(Protocol):
    """One of link/services' clients."""

    def receive(self, received: Received, now: float) -> None:
        """Handle a message."""

    def tick(self, now: float) -> None:
        """Let time pass."""

    def messages_to_send(self) -> list[Outgoing]:
        """Return what to send now."""


class Station:
    """A `link.core.Core` that sends HEARTBEAT, passes messages to its clients, and keeps the newest of each kind."""

    def __init__(self) -> None:
        self.params = ParamClient(SYSTEM, COMPONENT, target_system=VEHICLE[0])
        self.missions = MissionClient(SYSTEM, COMPONENT, target_system=VEHICLE[0])
        self.files = FtpClient(SYSTEM, COMPONENT, target_system=VEHICLE[0])
        self.newest: dict[int, m.Message] = {}
        self.texts: list[str] = []
        self.bytes_received = 0
        """Of the link, as of the last report."""
        self._clients: list[Client] = [self.params, self.missions, self.files]
        self._outgoing: list[Outgoing] = []
        self._heartbeat_due = 0.0
        self._waiters: list[tuple[Callable[[], bool], asyncio.Future[None]]] = []

    # ---- core ----

    def receive(self, received: Received, now: float) -> None:
        """Handle one message."""
        self.newest[type(received.message).id] = received.message
        if isinstance(received.message, m.StatusText):
            self.texts.append(m.decode_text(received.message))
        for client in self._clients:
            client.receive(received, now)
        self._look()

    def tick(self, now: float) -> None:
        """Let time pass."""
        if now >= self._heartbeat_due:
            self._heartbeat_due = now + HEARTBEAT_PERIOD
            self._outgoing.append(
                Outgoing(m.Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, SystemState.ACTIVE, 3))
            )
            self._outgoing.append(
                Outgoing(m.CommandLong(*VEHICLE, Command.REQUEST_MESSAGE, 0, m.RoverDriveInfo.id, *(0.0,) * 6))
            )
        for client in self._clients:
            client.tick(now)
        self._look()

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Keep what the link reports."""
        self.bytes_received = sum(each.bytes_received for each in reports)

    def messages_to_send(self) -> list[Outgoing]:
        """Return what to send now and clear the queue."""
        outgoing, self._outgoing = self._outgoing, []
        for client in self._clients:
            outgoing += client.messages_to_send()
        return outgoing

    # ---- for scripts ----

    def add_client(self, client: Client) -> None:
        """Let a further client hear, wait and send."""
        self._clients.append(client)

    async def until(self, condition: Callable[[], bool], what: str, within: float) -> None:
        """Wait until `condition`, checked with each message and each tick. Raises BenchmarkError."""
        found: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiters.append((condition, found))
        try:
            await asyncio.wait_for(found, within)
        except TimeoutError:
            raise BenchmarkError(f"not within {within:g} s: {what}; the vehicle says {self.texts[-3:]}") from None

    async def command(self, command: int, *params: float, within: float = 10.0) -> None:
        """Repeat a command until it is accepted."""
        for _ in range(round(within / REPEAT_AFTER)):
            self.newest.pop(m.CommandAck.id, None)
            self._outgoing.append(Outgoing(m.CommandLong(*VEHICLE, command, 0, *params, *(0.0,) * (7 - len(params)))))
            try:
                await self.until(lambda: self._accepted(command), f"command {command}", REPEAT_AFTER)
            except BenchmarkError:
                continue
            return
        raise BenchmarkError(f"command {command} was not accepted; the vehicle says {self.texts[-3:]}")

    async def arm(self) -> None:
        """Take control and arm."""
        await self.command(Command.COMPONENT_ARM_DISARM, 1)
        await self.until(lambda: self.armed, "the vehicle is armed", 10)

    @property
    def armed(self) -> bool:
        """Return whether the newest HEARTBEAT says that the vehicle is armed."""
        beat = self.newest.get(m.Heartbeat.id)
        return isinstance(beat, m.Heartbeat) and bool(beat.base_mode & ModeFlag.ARMED)

    def _accepted(self, command: int) -> bool:
        ack = self.newest.get(m.CommandAck.id)
        return isinstance(ack, m.CommandAck) and ack.command == command and ack.result == Result.ACCEPTED

    def _look(self) -> None:
        for condition, found in self._waiters:
            if not found.done() and condition():
                found.set_result(None)
        self._waiters = [each for each in self._waiters if not each[1].done()]


async def connected(endpoint: str, script: Callable[[Station], Awaitable[None]]) -> None:
    """Run a script with a station on a link, once it has received from the vehicle."""
    station = Station()
    runner = Runner(
        station, open_links([endpoint], system=SYSTEM, component=COMPONENT, side=Side.GROUND_STATION), period=PERIOD
    )
    running = asyncio.ensure_future(runner.run())
    try:
        await station.until(lambda: m.Heartbeat.id in station.newest, "a HEARTBEAT of the vehicle", 20)
        await script(station)
    finally:
        runner.stop()
        await running
