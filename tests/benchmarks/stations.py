"""What ground stations cost the vehicle: CPU and memory with 1, 4, 16 and 64 of them on one UDP port.

Each sends HEARTBEAT once a second and reads what it gets; one has armed and drives at 20 Hz. They live in this process
and only count, so that they need little of the machine.
"""

from __future__ import annotations

import random
import socket
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, field
from statistics import median

from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Autopilot, Command, ModeFlag, SystemState, VehicleType
from link.protocol.frame import payload_of
from link.protocol.framer import Framer
from link.protocol.peer_table import MAX_PEERS
from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Row, Table, brief
from tests.benchmarks.procfs import cpu_seconds, family, memory
from tests.benchmarks.programs import Program, free_port, on_pipe, python
from tests.benchmarks.traffic import framed
from tests.benchmarks.watch import Watch

COUNTS = (1, 4, 16, 64)
CPU, MEMORY = ((1, 2.0), (16, 2.5), (64, 4.0)), 34.0
"""Stations and % of a core; MiB."""
WINDOW, QUICK_WINDOW = 5.0, 2.0
"""s over which CPU time is counted."""
WARM_UP = 2.0
COMPONENT = 190
BEAT, DEMAND = 1.0, 0.05
"""s between two HEARTBEATs, and between two demands of the one that drives."""
MODE_AT = 6
"""Byte of a HEARTBEAT's payload that holds base_mode."""


class Light:
    """One ground station that only counts what it receives."""

    def __init__(self, watch: Watch, port: int, system: int) -> None:
        self.heard = 0
        """Messages."""
        self.beats = 0
        """HEARTBEATs of the vehicle among them."""
        self.armed = False
        self._system = system
        self._sequence = 0
        self._framer = Framer(stream=False)
        self._watch = watch
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect(("127.0.0.1", port))
        self._socket.setblocking(False)
        watch.add(self._socket.fileno(), self._read)

    def say(self, message: m.Message) -> None:
        """Send one datagram."""
        self._sequence = (self._sequence + 1) & 0xFF
        self._socket.send(framed(message, self._sequence, self._system, COMPONENT))

    def beat(self) -> None:
        """Send HEARTBEAT."""
        self.say(m.Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, SystemState.ACTIVE, 3))

    def close(self) -> None:
        """Close the socket."""
        self._watch.remove(self._socket.fileno())
        self._socket.close()

    def _read(self) -> bool:
        try:
            while True:
                for message_id, *_, raw in self._framer.feed(self._socket.recv(2048), 0.0):
                    self.heard += 1
                    if message_id == m.Heartbeat.id:
                        self.beats += 1
                        self.armed = bool(payload_of(raw)[MODE_AT] & ModeFlag.ARMED)
        except BlockingIOError:
            return True


class Crowd:
    """All stations of one vehicle; the first one drives."""

    def __init__(self, watch: Watch, stations: Sequence[Light]) -> None:
        self._watch = watch
        self._stations = stations
        self._chance = random.Random(3)
        self._axes = Axes()
        now = time.monotonic()
        self._beats_due = [now + BEAT * number / len(stations) for number in range(len(stations))]
        self._demand_due = now

    def pass_time(self, seconds: float) -> None:
        """Send what is due for all stations."""
        end = time.monotonic() + seconds
        while (now := time.monotonic()) < end:
            for number, station in enumerate(self._stations):
                if now >= self._beats_due[number]:
                    self._beats_due[number] += BEAT
                    station.beat()
            if now >= self._demand_due:
                self._demand_due += DEMAND
                self._stations[0].say(build_manual_control(self._axes, 1))
            self._watch.pause(min(end, self._demand_due, *self._beats_due) - time.monotonic())

    def drive(self) -> None:
        """Arm and go ahead. Raises BenchmarkError."""
        driver, deadline = self._stations[0], time.monotonic() + 10
        while not driver.armed:
            if time.monotonic() > deadline:
                raise BenchmarkError("the vehicle does not arm")
            driver.say(m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0))
            self.pass_time(0.5)
        self._axes = Axes(throttle=0.5, steering=0.2)

    @property
    def throttle(self) -> float:
        """Throttle of the demand."""
        return self._axes.throttle

    def drive_at(self, axes: Axes) -> None:
        """Change the demand, and send it at once."""
        self._axes = axes
        self._stations[0].say(build_manual_control(axes, 1))


@dataclass(slots=True)
class Seen:
    """Results with this number of stations; one value per round."""

    cpu: list[float] = field(default_factory=list)
    rss: list[float] = field(default_factory=list)
    told: list[float] = field(default_factory=list)
    """Messages a second of the station that got least and of the one that drives."""
    driver: list[float] = field(default_factory=list)
    reached: list[int] = field(default_factory=list)
    """Stations that received HEARTBEATs all the time."""


def run(options: Options) -> Report:
    """Measure round by round, the counts in turn."""
    seen = {count: Seen() for count in COUNTS}
    for turn in range(ROUNDS):
        for count in COUNTS:
            options.say(f"stations: round {turn + 1} of {ROUNDS}, {count} stations")
            _measure(seen[count], count, QUICK_WINDOW if options.quick else WINDOW)
    note = f"A link of the vehicle has {MAX_PEERS} places; a bridge before it serves more. "
    note += "One of them drives at 20 Hz. CPU: 100 % is one core. least: of the station that is told least."
    table = Table("mavhelm vehicle --sim with ground stations", [_row(*each) for each in seen.items()], note)
    goals = [Goal(f"vehicle, {count} stations reached", min(seen[count].reached), count, "", True) for count in COUNTS]
    alone = f"1 station, {brief(median(seen[1].cpu))} %"
    goals += [
        Goal(
            f"vehicle with {count} stations, CPU",
            median(seen[count].cpu),
            most,
            "%",
            reference=alone if count > 1 else "",
        )
        for count, most in CPU
    ]
    goals.append(Goal("vehicle, memory with the most stations", median(seen[COUNTS[-1]].rss), MEMORY, "MiB"))
    return Report([table], goals)


def _measure(seen: Seen, count: int, window: float) -> None:
    with _crowd(count) as (vehicle, stations, crowd):
        crowd.drive()
        crowd.pass_time(WARM_UP)
        pids = family(vehicle.pid)
        cpu, started = cpu_seconds(pids), time.monotonic()
        before = [(each.heard, each.beats) for each in stations]
        crowd.pass_time(window)
        spent = time.monotonic() - started
        if not stations[0].armed:
            raise BenchmarkError("the vehicle disarmed while it was driven")
        seen.cpu.append(100 * (cpu_seconds(pids) - cpu) / spent)
        seen.rss.append(memory(pids).rss)
        told = [each.heard - heard for each, (heard, _) in zip(stations, before, strict=True)]
        seen.told.append(min(told) / spent)
        seen.driver.append(told[0] / spent)
        beats = [each.beats - heard for each, (_, heard) in zip(stations, before, strict=True)]
        seen.reached.append(sum(each >= int(spent) - 1 for each in beats))


@contextmanager
def _crowd(count: int) -> Iterator[tuple[Program, list[Light], Crowd]]:
    with ExitStack() as stack:
        watch = stack.enter_context(closing(Watch()))
        port = free_port()
        vehicle = on_pipe(watch, python("vehicle", "--sim", f"udpin:127.0.0.1:{port}"))
        stack.callback(vehicle.end)
        vehicle.wait_for("ready", 20)
        stations = [stack.enter_context(closing(Light(watch, port, 255 - number))) for number in range(count)]
        yield vehicle, stations, Crowd(watch, stations)


def _row(count: int, seen: Seen) -> Row:
    return {
        "stations": count,
        "reached": min(seen.reached),
        "CPU %": median(seen.cpu),
        "CPU % of rounds": " / ".join(f"{value:.1f}" for value in seen.cpu),
        "RSS MiB": median(seen.rss),
        "driver, messages/s": median(seen.driver),
        "least, messages/s": median(seen.told),
    }
