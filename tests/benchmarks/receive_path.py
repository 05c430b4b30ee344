"""The vehicle's work on one demand: frame found, checked, decoded, selected, mixed, ramped, gated, written to the
motors.

Hot is a loop in virtual time; cold is the same at 50 Hz, where caches are cold and the clock of the core is low.
"""

from __future__ import annotations

import select
import time
from collections.abc import Callable, Iterator
from typing import Any

from dialects.axes import Axes, build_manual_control
from dialects.enums import Autopilot, Command, SystemState, VehicleType
from dialects.messages import CommandLong, Heartbeat, Message, RoverOperatorPresence
from link.protocol.channel import Channel
from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Spread, Table, brief, spread
from tests.benchmarks.plain_pymavlink import plain_module
from tests.benchmarks.traffic import framed
from vehicle.control_loop import ControlLoop
from vehicle.motors.simulated import SimulatedMotors
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.sim.body import SimulatedBody

CYCLE = 0.02
"""s; control cycle of the vehicle, and time between two demands here."""
ADDRESS = ("127.0.0.1", 14550)
MANUAL = "MANUAL_CONTROL to outputs"
PRESENCE = "ROVER_OPERATOR_PRESENCE before it"
REFERENCE = "pymavlink parse_buffer of the same MANUAL_CONTROL, decode only"


def run(options: Options) -> Report:
    """Measure hot and cold."""
    report = Report()
    for name, count, pace in (("hot", 5000, _at_once), ("cold, 50 Hz", 250, _cold)):
        options.say(f"receive_path: {name}")
        measured = _rounds(count // 10 if options.quick else count, pace)
        rows = [_row(step, each, measured[REFERENCE]) for step, each in measured.items()]
        report.tables.append(Table(f"Vehicle's receive path, {name}: us a frame", rows))
        times_as_long, decode = measured[MANUAL].p50 / measured[REFERENCE].p50, brief(measured[REFERENCE].p50)
        beside = f"pymavlink's decode of that frame alone, {decode} us"
        report.goals.append(Goal(f"{MANUAL}, {name}, p50", times_as_long, LIMITS[pace], "x", reference=beside))
    return report


def _row(step: str, each: Spread, reference: Spread) -> dict[str, Any]:
    return {
        "step": step,
        "frames": each.samples,
        "p50": each.p50,
        "p90": each.p90,
        "p99": each.p99,
        "max": each.max,
        "x p50": reference.p50 / each.p50,
    }


Pace = Callable[[int], Iterator[int]]


def _at_once(count: int) -> Iterator[int]:
    return iter(range(count))


def _cold(count: int) -> Iterator[int]:
    start = time.monotonic()
    for each in range(count):
        select.select([], [], [], max(0.0, start + each * CYCLE - time.monotonic()))
        yield each


LIMITS: dict[Pace, float] = {_at_once: 1.5, _cold: 2.0}
"""Times as long as pymavlink's decode of that frame alone."""


def _rounds(count: int, pace: Pace) -> dict[str, Spread]:
    samples: dict[str, list[list[float]]] = {MANUAL: [], PRESENCE: [], REFERENCE: []}
    for _ in range(ROUNDS):
        for name, values in _one_round(count, pace).items():
            samples[name].append(values)
    return {name: spread(rounds) for name, rounds in samples.items()}


def _one_round(count: int, pace: Pace) -> dict[str, list[float]]:
    vehicle = VehicleInMemory()
    vehicle.arm()
    parser = plain_module().MAVLink(None)
    times: dict[str, list[float]] = {MANUAL: [], PRESENCE: [], REFERENCE: []}
    for each in pace(count):
        presence, demand = vehicle.demand(each)
        times[PRESENCE].append(_timed(lambda frame=presence: vehicle.take(frame)))  # type: ignore[misc]
        times[MANUAL].append(_timed(lambda frame=demand: vehicle.take(frame)))  # type: ignore[misc]
        times[REFERENCE].append(_timed(lambda frame=demand: parser.parse_buffer(frame)))  # type: ignore[misc]
        vehicle.cycle()
    if not vehicle.turning:
        raise BenchmarkError("the wheels did not turn, so this is not the path of a demand")
    return times


def _timed(work: Callable[[], object]) -> float:
    """us"""
    start = time.perf_counter_ns()
    work()
    return (time.perf_counter_ns() - start) / 1e3


class VehicleInMemory:
    """The daemon's cores without its loop: channel, control loop, rover, simulated body. cycle() moves the time."""

    def __init__(self) -> None:
        self._now = 100.0
        motors = SimulatedMotors()
        self._motors = motors
        rover = Rover(Params({}), now=self._now)
        self._machine = ControlLoop(rover, motors, SimulatedBody(lambda: motors.outputs))
        self._channel = Channel("udpin:bench", 0, system=1, component=1)
        self._sequence = 0

    @property
    def turning(self) -> bool:
        """Return whether the wheels get power."""
        return any(self._motors.outputs)

    def arm(self) -> None:
        """Introduce a ground station, arm, and send neutral."""
        arm = CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0)
        for message in (Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, SystemState.ACTIVE, 3), arm):
            self.take(self._frame(message))
            self._wait(0.5)
        for _ in range(10):
            self.take(self._frame(build_manual_control(Axes(), 1)))
            self.cycle()

    def demand(self, number: int) -> tuple[bytes, bytes]:
        """Return operator presence and demand, different each time."""
        alive = RoverOperatorPresence(1, 1, number, 0, 7, number, 0, 0)
        axes = Axes(0.5 + 0.3 * (number % 2), 0.1 * (number % 3))
        return self._frame(alive), self._frame(build_manual_control(axes, 1))

    def take(self, data: bytes) -> None:
        """Do what the runner does with a datagram, down to the motors."""
        for received in self._channel.receive(data, ADDRESS, self._now):
            self._machine.receive(received, self._now)

    def cycle(self) -> None:
        """Let 20 ms pass and discard what the rover sends. Its ground station's heartbeat is sent when it is due."""
        before, self._now = int(self._now), self._now + CYCLE
        if int(self._now) != before:
            self.take(self._frame(Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, SystemState.ACTIVE, 3)))
        self._machine.tick(self._now)
        self._machine.messages_to_send()

    def _wait(self, seconds: float) -> None:
        for _ in range(round(seconds / CYCLE)):
            self.cycle()

    def _frame(self, message: Message) -> bytes:
        self._sequence = (self._sequence + 1) & 0xFF
        return framed(message, self._sequence, 255, 190)
