"""What a bridge costs between one vehicle that sends 500 messages a second and 1, 10 and 100 ground stations on UDP.

Each station sends HEARTBEAT once a second and gets every message. The stations only count, in this process.
"""

from __future__ import annotations

import socket
import time
from contextlib import ExitStack, closing, suppress
from dataclasses import dataclass, field
from statistics import median

from dialects import messages as m
from dialects.enums import Autopilot, SystemState, VehicleType
from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Row, Table, brief
from tests.benchmarks.procfs import cpu_seconds, family
from tests.benchmarks.programs import free_port, on_pipe, python
from tests.benchmarks.traffic import framed, mix
from tests.benchmarks.watch import Watch

COUNTS = (1, 10, 100)
RATE = 500
"""Messages/s of the vehicle, each a datagram of its own."""
WINDOW, QUICK_WINDOW = 5.0, 2.0
"""s over which CPU time is counted."""
INTRODUCTION, START_WITHIN = 1.0, 6.0
"""s in which the stations send HEARTBEATs, and s until all must have got something."""
HALF_A_CORE = 50.0


@dataclass(slots=True)
class Cost:
    """One value per round."""

    cpu: list[float] = field(default_factory=list)
    """% of a core."""
    share: list[float] = field(default_factory=list)
    """us for one message to one station."""
    reached: list[int] = field(default_factory=list)
    """Stations that got messages."""
    joined: list[float] = field(default_factory=list)
    """Messages in one datagram: the bridge joins what it reads at once, and waits for nothing."""


class Stations:
    """Sockets of ground stations, and how many datagrams each has got."""

    def __init__(self, watch: Watch, stack: ExitStack, port: int, count: int) -> None:
        self.heard = [0] * count
        self._beats = 0
        self._sockets = [stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) for _ in range(count)]
        for number, sock in enumerate(self._sockets):
            sock.connect(("127.0.0.1", port))
            sock.setblocking(False)
            watch.add(sock.fileno(), lambda number=number: self._read(number))  # type: ignore[misc]

    def beat(self) -> None:
        """Send a HEARTBEAT of each; the bridge may not listen yet."""
        self._beats = (self._beats + 1) & 0xFF
        beat = m.Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, SystemState.ACTIVE, 3)
        for number, sock in enumerate(self._sockets):
            with suppress(ConnectionRefusedError):
                sock.send(framed(beat, self._beats, 254 - number, 190))

    def _read(self, number: int) -> bool:
        try:
            while True:
                self._sockets[number].recv(2048)
                self.heard[number] += 1
        except (BlockingIOError, ConnectionRefusedError):
            return True


class Vehicle:
    """A vehicle that sends telemetry at a steady pace."""

    def __init__(self, stack: ExitStack, port: int) -> None:
        self._socket = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        self._socket.connect(("127.0.0.1", port))
        self._frames = mix(256)
        self.sent = 0

    def send(self) -> None:
        """Send the next message."""
        with suppress(ConnectionRefusedError):
            self._socket.send(self._frames[self.sent & 0xFF])
        self.sent += 1


def run(options: Options) -> Report:
    """Measure round by round, the counts in turn."""
    costs = {count: Cost() for count in COUNTS}
    for turn in range(ROUNDS):
        for count in COUNTS:
            options.say(f"bridge_stations: round {turn + 1} of {ROUNDS}, {count} stations")
            _measure(costs[count], count, QUICK_WINDOW if options.quick else WINDOW)
    note = f"A vehicle sends {RATE} messages/s, which go to all. CPU: 100 % is one core."
    table = Table("bridge with ground stations on UDP", [_row(*each) for each in costs.items()], note)
    shares = [(count, median(cost.share)) for count, cost in costs.items()]
    beside = [f"to one of {count}, {brief(share)} us" for count, share in shares]
    cpu = f"with {COUNTS[0]}, {brief(median(costs[COUNTS[0]].cpu))} %"
    most = COUNTS[-1]
    goals = [
        Goal(f"bridge, CPU with {most} stations", median(costs[most].cpu), HALF_A_CORE, "%", reference=cpu),
        *(
            Goal(f"bridge, CPU of a message to one of {more} stations", ours / theirs, 1.0, "x", False, text)
            for (more, ours), theirs, text in zip(shares[1:], [each for _, each in shares], beside, strict=False)
        ),
        *(Goal(f"{count} stations, reached", min(costs[count].reached), count, "", True) for count in COUNTS),
    ]
    return Report([table], goals)


def _measure(cost: Cost, count: int, window: float) -> None:
    with ExitStack() as stack:
        watch = stack.enter_context(closing(Watch()))
        ports = free_port(), free_port()
        words = python("link.bridge", *(f"udpin:127.0.0.1:{port}" for port in ports), "--quiet")
        bridge = on_pipe(watch, words)
        stack.callback(bridge.end)
        stations, vehicle = Stations(watch, stack, ports[1], count), Vehicle(stack, ports[0])
        pids = family(bridge.pid)
        deadline = time.monotonic() + START_WITHIN
        while not all(stations.heard) and time.monotonic() < deadline:
            _pass_time(watch, vehicle, stations, time.monotonic() + INTRODUCTION)
        if not any(stations.heard):
            raise BenchmarkError("the bridge forwards nothing")
        before, cpu, sent = list(stations.heard), cpu_seconds(pids), vehicle.sent
        _pass_time(watch, vehicle, stations, time.monotonic() + window)
        used = cpu_seconds(pids) - cpu
        told = [after - earlier for after, earlier in zip(stations.heard, before, strict=True)]
        cost.cpu.append(100 * used / window)
        cost.share.append(used / ((vehicle.sent - sent) * count) * 1e6)
        cost.reached.append(sum(each > 0 for each in told))
        cost.joined.append((vehicle.sent - sent) / max(1, median(told)))


def _pass_time(watch: Watch, vehicle: Vehicle, stations: Stations, end: float) -> None:
    """Send what is due until `end`, s monotonic."""
    message = beat = time.monotonic()
    while (now := time.monotonic()) < end:
        if now >= beat:
            beat += 1.0
            stations.beat()
        if now >= message:
            message += 1 / RATE
            vehicle.send()
        watch.pause(min(end, beat, message) - time.monotonic())


def _row(count: int, cost: Cost) -> Row:
    return {
        "stations": count,
        "reached": min(cost.reached),
        "CPU %": median(cost.cpu),
        "CPU % of rounds": " / ".join(f"{value:.1f}" for value in cost.cpu),
        "us a message and station": median(cost.share),
        "messages a datagram": median(cost.joined),
    }
