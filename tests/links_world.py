"""A station and a vehicle joined by several links, in virtual time: each is late, lossy, reordered, cut or frozen.

The station and the vehicle are those of `tests/test_stops.py`; `foreign` vehicles are fakes of `tests/fakes`.
"""

from __future__ import annotations

import heapq
import random
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field

from dialects.messages import Message
from groundstation.intents.driving import DriveKeyDown, SetStyle
from groundstation.intents.session import RenewLease, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Arm
from groundstation.station.station import Station
from link.core import Core, SendGuard, SendListener
from link.protocol.channel import Channel
from link.runner import REPORT_PERIOD
from vehicle.control_loop import ControlLoop
from vehicle.motors.simulated import SimulatedMotors
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.safety.states import SafetyState
from vehicle.sim.battery import Battery
from vehicle.sim.body import SimulatedBody, SimulatedHome
from vehicle.sim.chassis import ChassisDimensions, SkidChassis

STEP = 0.005
PERIOD = 0.02
"""s between ticks of both ends."""


@dataclass
class Path:
    """Both directions of one link. `delay` and `jitter` in s; with `jitter` frames overtake each other."""

    delay: float = 0.0
    jitter: float = 0.0
    loss: float = 0.0
    cut: bool = False
    """All is lost, also what is under way."""
    frozen: bool = False
    """All waits, and comes at once afterwards, as from a buffer."""
    seed: int = 0
    under_way: dict[bool, list[tuple[float, int, bytes]]] = field(default_factory=lambda: {True: [], False: []})
    """To the vehicle -> frames."""

    def __post_init__(self) -> None:
        self._random = random.Random(self.seed)
        self._count = 0

    def send(self, data: bytes, now: float, *, up: bool) -> None:
        if self.cut or self._random.random() < self.loss:
            return
        self._count += 1
        arrival = now + max(0.0, self.delay + self._random.uniform(-self.jitter, self.jitter))
        heapq.heappush(self.under_way[up], (arrival, self._count, data))

    def receive(self, now: float, *, up: bool) -> list[bytes]:
        queue, found = self.under_way[up], []
        if self.cut:
            queue.clear()
        while queue and queue[0][0] <= now and not self.frozen:
            found.append(heapq.heappop(queue)[2])
        return found


class End:
    """A core with a channel for each link, driven as the runner would."""

    def __init__(self, core: Core, ids: tuple[int, int], links: int, other: Hashable) -> None:
        self.core = core
        self.channels = [
            Channel(f"link {n}", n, system=ids[0], component=ids[1], target=other, first_sequence=77 * n)
            for n in range(links)
        ]
        self.sent: list[tuple[float, int, Message]] = []
        """When, on which link, what."""
        self.tick_due = self.report_due = 0.0

    def receive(self, link: int, data: bytes, address: Hashable, now: float) -> None:
        for received in self.channels[link].receive(data, address, now):
            self.core.receive(received, now)

    def advance(self, now: float) -> None:
        due = getattr(self.core, "due_at", None)
        if now < self.tick_due:
            if due is not None and now >= due:
                self.core.act(now)  # type: ignore[attr-defined]
            return
        if now >= self.report_due:
            self.report_due = now + REPORT_PERIOD
            for channel in self.channels:
                channel.expire_peers(now)
            self.core.observe([channel.report(now=now) for channel in self.channels], now)
        self.core.tick(now)
        self.tick_due = max(self.tick_due + PERIOD, now)

    def pop_frames(self, now: float) -> list[tuple[int, bytes]]:
        found = []
        for outgoing in self.core.messages_to_send():
            if isinstance(self.core, SendGuard) and not self.core.may_send(outgoing.message, now):
                continue
            for channel in self.channels:
                for data, _, sequence in channel.send(outgoing, now=now):
                    self.sent.append((now, channel.index, outgoing.message))
                    found.append((channel.index, data))
                    if isinstance(self.core, SendListener):
                        self.core.handle_sent(outgoing.message, sequence, now)
        return found


class LinksDrive:
    """An operator with keys, a station, several links and a vehicle: the simulated rover unless another is given."""

    def __init__(self, *paths: Path, vehicle: Core | None = None, session: int = 7) -> None:
        self.now = self._start = 100.0
        self._steps = 0
        self.paths = paths
        self.station = Station([f"link {n}" for n in range(len(paths))], now=self.now, session=session)
        self.motors = SimulatedMotors()
        params = Params({})
        self.rover = Rover(params, now=self.now)
        body = SimulatedBody(
            lambda: self.motors.outputs,
            chassis=SkidChassis(ChassisDimensions(top_speed=params["SPEED_MAX"], track_width=params["TRACK_WIDTH"])),
            battery=Battery(1.0),
            home=SimulatedHome(),
            seed=None,
        )
        self.near = End(self.station, (255, 190), len(paths), "far")
        self.far = End(vehicle or ControlLoop(self.rover, self.motors, body), (1, 1), len(paths), "near")
        self.held: str | None = None
        self._key_due = self._lease_due = 0.0
        self.each: Callable[[float], None] = lambda now: None
        """Called once a step."""
        self.tell(SetStyle("hold"), SetKeyGate(True))

    @property
    def power(self) -> float:
        """The largest motor output now."""
        return max(map(abs, self.motors.outputs), default=0.0)

    def tell(self, *intents: AnyIntent) -> None:
        for intent in intents:
            self.station.handle_intent(intent, self.now)
        self._exchange()

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / STEP)):
            self._steps += 1
            self.now = self._start + self._steps * STEP
            for link, path in enumerate(self.paths):
                for data in path.receive(self.now, up=False):
                    self.near.receive(link, data, "far", self.now)
                for data in path.receive(self.now, up=True):
                    self.far.receive(link, data, "near", self.now)
            self.near.advance(self.now)
            self.far.advance(self.now)
            self._exchange()
            self._operate()
            self.each(self.now)

    def until(self, condition: Callable[[], bool], within: float = 10.0) -> float:
        """Let time pass until `condition`; return how long it took."""
        start = self.now
        while not condition():
            assert self.now - start < within, f"not within {within} s"
            self.run(STEP)
        return self.now - start

    def arm(self) -> None:
        """Arm as an operator does, who waits for the vehicle to be found and tries again."""
        self.until(lambda: self.station.snapshot(self.now, 0).vehicle is not None)
        self.run(2.0)
        self.tell(Arm(held=1.0))
        self.until(lambda: any(contact.state.armed for contact in self.station.fleet))
        self.run(1.5)

    def get_going(self) -> None:
        """Arm, press the key, and wait until the wheels turn."""
        self.arm()
        assert self.rover.state is SafetyState.ARMED
        self.held = "i"
        self.until(lambda: self.power > 0.5)

    def _operate(self) -> None:
        if self.now >= self._lease_due:
            self._lease_due = self.now + 0.1
            self.station.handle_intent(RenewLease(), self.now)
        if self.held and self.now >= self._key_due:
            self._key_due = self.now + 0.04
            self.station.handle_intent(DriveKeyDown(self.held, 1, 0), self.now)

    def _exchange(self) -> None:
        for link, data in self.near.pop_frames(self.now):
            self.paths[link].send(data, self.now, up=True)
        for link, data in self.far.pop_frames(self.now):
            self.paths[link].send(data, self.now, up=False)
