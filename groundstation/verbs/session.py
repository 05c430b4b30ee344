"""A ground station without a screen for one verb: finds a vehicle and makes requests to it."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Sequence

from dialects import messages as m
from groundstation.station.heartbeat_sender import HeartbeatSender
from groundstation.vehicles.fleet import is_vehicle
from groundstation.vehicles.message_log import MessageLog
from groundstation.vehicles.requests import RequestReport, RequestState
from groundstation.vehicles.services import VehicleServices
from groundstation.vehicles.vehicle_state import VehicleState
from groundstation.verbs.exit_codes import ExitCode, VerbError
from link.core import LinkReport, Outgoing, Received
from link.runner import Runner, open_links

COMPONENT = 190
"""MAV_COMP_ID_MISSIONPLANNER: the component id that ground stations use."""
PERIOD = 0.02
"""s between two ticks: twice the shortest round trip of a radio."""
ALONE_AFTER = 1.3
"""s for which the links are heard before a vehicle counts as the only one: a heartbeat interval and a delay."""

RequestStart = Callable[[int, float], None]
"""Starts a request, with its number and the time."""


class VerbCore:
    """A core (link/core.py) with one vehicle: `wanted`, or the first that is heard."""

    def __init__(self, system: int, wanted: int | None) -> None:
        self.state: VehicleState | None = None
        self.services: VehicleServices | None = None
        self.vehicles: set[int] = set()
        """System ids of all vehicles heard."""
        self._system = system
        self._wanted = wanted
        self._log = MessageLog()
        self._heartbeat = HeartbeatSender(0.0)
        self._outbox: list[Outgoing] = []
        self._looks: list[tuple[Callable[[], bool], asyncio.Future[None]]] = []

    def receive(self, received: Received, now: float) -> None:
        """Handle one message; the HEARTBEAT of the wanted vehicle begins the conversation."""
        message = received.message
        if is_vehicle(message):
            self._heartbeat.greet(received.peer, now)
            self.vehicles.add(received.system)
            if self.state is None and self._wanted in (None, received.system):
                self._attach(received)
        if self.state is None or self.services is None or received.system != self.state.system:
            return
        self.state.receive(received, now)
        self.services.autopilot, self.services.kind = self.state.autopilot, self.state.kind
        if isinstance(message, m.StatusText):
            text = self._log.handle_statustext(message, received.system, now)
            if text is not None:
                self.services.handle_text(text, message.severity, now)
        self.services.receive(received, now)
        self._look()

    def tick(self, now: float) -> None:
        """Send heartbeats, repeat what is overdue."""
        self._outbox += self._heartbeat.tick(now, driving=False)
        if self.services is not None:
            self.services.tick(now)
        self._look()

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Ignore the reports of the links."""

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them."""
        outbox, self._outbox = self._outbox, []
        return outbox + (self.services.messages_to_send() if self.services else [])

    def add_look(self, condition: Callable[[], bool]) -> asyncio.Future[None]:
        """Return a future that is done once `condition` holds, checked after each message and tick."""
        found: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._looks.append((condition, found))
        return found

    def _attach(self, received: Received) -> None:
        self.state = VehicleState(received.system, received.component)
        self.services = VehicleServices(self._system, COMPONENT, (received.system, received.component))

    def _look(self) -> None:
        for condition, found in self._looks:
            if not found.done() and condition():
                found.set_result(None)
        self._looks = [each for each in self._looks if not each[1].done()]


class VerbSession:
    """What a verb does with its vehicle. `progress` gets each report of a request that has changed."""

    def __init__(self, core: VerbCore, flush: Callable[[], None], progress: Callable[[RequestReport], None]) -> None:
        self._core = core
        self._flush = flush
        self._progress = progress
        self._count = 0
        self._ended: dict[int, RequestReport] = {}
        self._began = asyncio.get_running_loop().time()

    @property
    def services(self) -> VehicleServices:
        """The services of the vehicle, once it was heard."""
        assert self._core.services is not None
        return self._core.services

    @property
    def vehicle(self) -> VehicleState:
        """The vehicle, once it was heard."""
        assert self._core.state is not None
        return self._core.state

    async def find_vehicle(self, wait: float, wanted: int | None, where: str) -> None:
        """Wait for the HEARTBEAT of the vehicle. Raises VerbError after `wait` s."""
        try:
            await asyncio.wait_for(self._core.add_look(lambda: self._core.state is not None), wait)
        except TimeoutError:
            which = "no vehicle" if wanted is None else f"no vehicle {wanted}"
            heard = f", but {_numbers(self._core.vehicles)}" if self._core.vehicles else ""
            raise VerbError(ExitCode.NO_VEHICLE, f"{which} on {where} within {wait:g} s{heard}") from None

    async def need_only_vehicle(self, wanted: int | None) -> None:
        """Before the first change: without --vehicle there must be only one. Raises VerbError."""
        left = self._began + ALONE_AFTER - asyncio.get_running_loop().time()
        if wanted is None and left > 0:
            await asyncio.sleep(left)
        if wanted is None and len(self._core.vehicles) > 1:
            raise VerbError(
                ExitCode.USAGE, f"vehicles {_numbers(self._core.vehicles)} are here: choose one with --vehicle"
            )

    async def request(self, start: RequestStart) -> RequestReport:
        """Make a request and return how it ended."""
        self._count += 1
        number = self._count
        start(number, asyncio.get_running_loop().time())
        self._flush()
        await self._core.add_look(lambda: self._collect(number))
        return self._ended.pop(number)

    def _collect(self, number: int) -> bool:
        for report in self.services.book.pop_changes():
            self._progress(report)
            if report.state is not RequestState.RUNNING:
                self._ended[report.number] = report
        return number in self._ended


def _numbers(systems: set[int]) -> str:
    return ", ".join(map(str, sorted(systems)))


async def run_session(
    endpoints: Sequence[str],
    system: int,
    wanted: int | None,
    script: Callable[[VerbSession], Awaitable[int]],
    progress: Callable[[RequestReport], None],
) -> int:
    """Open the links, run the script, and return its exit code. Raises EndpointError, LinkError, VerbError."""
    core = VerbCore(system, wanted)
    runner = Runner(core, open_links(endpoints, system=system, component=COMPONENT), period=PERIOD, route=False)
    running = asyncio.ensure_future(runner.run())
    await asyncio.sleep(0)  # run() begins
    verb = asyncio.ensure_future(script(VerbSession(core, runner.flush, progress)))
    try:
        await asyncio.wait({running, verb}, return_when=asyncio.FIRST_COMPLETED)
        if running.done():
            running.result()
        return await verb
    finally:
        verb.cancel()
        runner.stop()
        await running
