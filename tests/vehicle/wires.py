"""A rover behind real channels, and programs that send it frames with packet numbers of their own, late or twice.

Unlike `tests/vehicle/bench.py` everything goes through bytes, so that the rules of link/protocol/sequence.py apply.
"""

from __future__ import annotations

import heapq
import random
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field

import pytest

from dialects import codec
from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Command, Result
from dialects.modes import Mode
from dialects.traits import COMMANDS
from link.protocol.channel import Channel
from tests.vehicle.bench import BEAT, CYCLE, MESSAGE_IDS
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.safety.states import SafetyState

IDS = (255, 190)
BOOT = 100.0


@dataclass
class Wires:
    """`now` moves only in `wait`. `links` channels lead to the rover, and one more is for second links."""

    links: int = 1
    params: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.now = BOOT
        self.texts: list[str] = []
        self.rover = Rover(Params(self.params), now=BOOT, on_text=lambda severity, text: self.texts.append(text))
        self.channels = [
            Channel(f"link {n}", n, system=1, component=1, wanted=MESSAGE_IDS) for n in range(self.links + 1)
        ]
        self.sent: list[tuple[Hashable, m.Message]] = []
        """Address -> what the rover has sent there."""
        self._due: list[tuple[float, int, int, Hashable, bytes]] = []
        self._count = 0
        self._next_cycle = BOOT
        self._report_due = BOOT
        self.wait(2.0)

    @property
    def turning(self) -> bool:
        return any(self.rover.outputs.throttles)

    @property
    def throttle(self) -> float:
        return self.rover.outputs.throttles[0]

    @property
    def mode(self) -> Mode:
        return self.rover._safety.mode

    @property
    def armed(self) -> bool:
        return self.rover.state is SafetyState.ARMED

    def said(self, part: str) -> int:
        """How many texts have `part` in them."""
        return sum(part in text for text in self.texts)

    def put(self, data: bytes, address: Hashable, link: int = 0, delay: float = 0.0) -> None:
        """A frame that arrives in `delay` s, or at once."""
        self._count += 1
        heapq.heappush(self._due, (self.now + delay, self._count, link, address, data))
        self._deliver()

    def wait(self, seconds: float, each: Callable[[float], None] | None = None) -> None:
        """Let time pass; `each` is called before each cycle of 20 ms."""
        end = self.now + seconds
        while self._next_cycle <= end + 1e-9:
            self.now = self._next_cycle
            self._deliver()
            if each:
                each(self.now)
            if self.now >= self._report_due:
                self._report_due += 1.0
                for channel in self.channels:
                    channel.expire_peers(self.now)
                self.rover.observe([channel.report() for channel in self.channels], self.now)
            self.rover.tick(self.now)
            self._collect()
            self._next_cycle = self.now + CYCLE
        self.now = max(self.now, end)

    def _deliver(self) -> None:
        while self._due and self._due[0][0] <= self.now + 1e-9:
            _, _, link, address, data = heapq.heappop(self._due)
            for received in self.channels[link].receive(data, address, self.now):
                self.rover.receive(received, self.now)
            self._collect()

    def _collect(self) -> None:
        for outgoing in self.rover.messages_to_send():
            for channel in self.channels:
                self.sent += [(address, outgoing.message) for _, address, _ in channel.send(outgoing, now=self.now)]


class Program:
    """A ground station without sessions: it numbers its frames, and keeps them, so that they can come again."""

    def __init__(
        self, wires: Wires, address: Hashable = "gcs", *, ids: tuple[int, int] = IDS, link: int = 0, number: int = 0,
        delay: float = 0.0,
    ) -> None:  # fmt: skip
        self.wires, self.address, self.ids, self.link, self.delay = wires, address, ids, link, delay
        self.number = number
        self.frames: list[tuple[float, bytes]] = []
        """When each was sent, and its bytes."""
        self._due = self._beat_due = 0.0

    def send(self, message: m.Message, *, lost: bool = False) -> bytes:
        """Number and send a message."""
        data = codec.frame(type(message).id, codec.encode_payload(message), self.number, *self.ids)
        self.number = (self.number + 1) & 0xFF
        self.frames.append((self.wires.now, data))
        if not lost:
            self.wires.put(data, self.address, self.link, self.delay)
        return data

    def command(self, command: int, *params: float) -> Result | None:
        """Send a command; return the acknowledgement of one without delay."""
        before = len(self.wires.sent)
        one, two, three, four, five, six, seven = (*params, *(0.0,) * (7 - len(params)))
        self.send(m.CommandLong(1, 1, command, 0, one, two, three, four, five, six, seven))
        acks = [
            message
            for address, message in self.wires.sent[before:]
            if address == self.address and isinstance(message, m.CommandAck)
        ]
        return Result(acks[-1].result) if acks else None

    def arm(self) -> Result | None:
        return self.command(Command.COMPONENT_ARM_DISARM, 1)

    def disarm(self) -> Result | None:
        return self.command(Command.COMPONENT_ARM_DISARM, 0)

    def set_mode(self, mode: Mode) -> Result | None:
        return self.command(Command.DO_SET_MODE, 1, mode)

    def demand(self, axes: Axes, *, lost: bool = False) -> None:
        """Send one demand."""
        self.send(build_manual_control(axes, 1), lost=lost)

    def beat(self) -> None:
        """Send a HEARTBEAT."""
        self.send(BEAT)

    def step(self, axes: Axes | None, rate: float = 20.0, *, lost: bool = False) -> None:
        """Call it each cycle: heartbeats at 1 Hz, and demands at `rate`."""
        now = self.wires.now
        if now >= self._beat_due:
            self._beat_due = now + 1.0
            self.beat()
        if axes is not None and now >= self._due - 1e-9:
            self._due = now + 1.0 / rate
            self.demand(axes, lost=lost)

    def hold(self, seconds: float, axes: Axes | None, rate: float = 20.0) -> None:
        """Let time pass with this demand."""
        self.wires.wait(seconds, lambda now: self.step(axes, rate))

    def text(self, part: str) -> bool:
        """Return whether this program was sent a text with `part` in it."""
        return part in "".join(
            m.decode_text(message)
            for address, message in self.wires.sent
            if address in self.addresses and isinstance(message, m.StatusText)
        )

    @property
    def addresses(self) -> tuple[Hashable, ...]:
        """Where it is."""
        return (self.address,)


class SessionProgram(Program):
    """A ground station with sessions, as ours: each demand carries the vehicle's newest time."""

    session = 7
    clock = 1000

    def build(self, axes: Axes | None, *, age: float = 0.02) -> m.RoverOperatorPresence:
        """Build a proof whose echo is `age` s old."""
        self.clock += 1
        none = m.INVALID_AXIS
        x, r = (round(axes.throttle * 1000), round(axes.steering * 1000)) if axes else (none, none)
        echo = max(0, round((self.wires.now - BOOT - age) * 1000))
        return m.RoverOperatorPresence(1, 1, self.clock, echo, self.session, 1, 0, 16, x, none, none, r)

    def demand(self, axes: Axes, *, lost: bool = False) -> None:
        """Send one demand: the proof, and the MANUAL_CONTROL that follows it."""
        self.send(self.build(axes), lost=lost)
        super().demand(axes, lost=lost)

    def step(self, axes: Axes | None, rate: float = 20.0, *, lost: bool = False) -> None:
        """As Program; without a demand the proof alone goes out, twice a second."""
        if axes is None and self.wires.now >= self._due - 1e-9:
            self._due = self.wires.now + 0.5
            self.send(self.build(None))
        super().step(axes, rate, lost=lost)


class TwoLinks(SessionProgram):
    """A ground station with sessions that sends its state over a second link as well, 20 ms later."""

    second_number = 30

    def send(self, message: m.Message, *, lost: bool = False) -> bytes:
        data = super().send(message, lost=lost)
        if type(message).id not in COMMANDS:
            for extra in self.seconds(message):
                self.wires.put(extra, self.addresses[1], self.wires.links, self.delay + 0.02)
        return data

    @property
    def addresses(self) -> tuple[Hashable, ...]:
        return self.address, f"{self.address} by its second link"

    def seconds(self, message: m.Message) -> list[bytes]:
        """Return the frames of the second link."""
        self.second_number = (self.second_number + 1) & 0xFF
        return [codec.frame(type(message).id, codec.encode_payload(message), self.second_number, *self.ids)]


class HostileLinks(TwoLinks):
    """The same, and whoever holds the second link adds copies, old frames, and old demands under new numbers."""

    def __init__(
        self, wires: Wires, address: Hashable = "gcs", *, ids: tuple[int, int] = IDS, link: int = 0, number: int = 0,
        delay: float = 0.0,
    ) -> None:  # fmt: skip
        super().__init__(wires, address, ids=ids, link=link, number=number, delay=delay)
        self.chance = random.Random(number)
        self.old: list[tuple[m.Message, bytes]] = []

    def seconds(self, message: m.Message) -> list[bytes]:
        frames = super().seconds(message)
        self.old.append((message, frames[0]))
        del self.old[:-200]
        old, copy = self.chance.choice(self.old)
        return [*frames, copy, *(super().seconds(old) if self.chance.random() < 0.5 else [])]


def drive_fully(kind: type[Program], wires: Wires) -> Program:
    """Return a driver at full throttle."""
    driver = kind(wires)
    driver.hold(1.0, None)
    assert driver.arm() is Result.ACCEPTED
    driver.hold(0.3, Axes())
    driver.hold(1.0, Axes(throttle=1.0))
    assert wires.throttle == pytest.approx(1.0, abs=0.05)
    return driver
