"""What strangers that flood a vehicle cost its driver: CPU, the way of a demand, and the stop of a new ground station.

The driver is in this process and drives at 20 Hz; the strangers are a process of their own (stranger_flood.py). Every
round stops the rover by a disarm from a ground station that was never heard before, repeated as ours repeats it.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, field
from statistics import median

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import Command
from link.services.command.client import REPEAT_AFTER
from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Row, Table, brief
from tests.benchmarks.motor_feed import MotorFeed
from tests.benchmarks.procfs import cpu_seconds, family
from tests.benchmarks.programs import Program, free_port, on_pipe, python, scratch
from tests.benchmarks.stations import Crowd, Light
from tests.benchmarks.stranger_flood import FLOODS
from tests.benchmarks.watch import Watch

NOBODY = "nobody"
WINDOW, QUICK_WINDOW = 4.0, 2.0
"""s over which CPU time and log are counted."""
CHANGE = 0.4
"""s between two changes of the demand, whose way to the motors is measured."""
TRIES = 20
"""Disarms until the benchmark gives up."""
DRIVER, NEWCOMER = 255, 9
"""System ids."""


@dataclass(slots=True)
class Seen:
    """Results under one flood; one value a round, but for the demands."""

    cpu: list[float] = field(default_factory=list)
    demands: list[float] = field(default_factory=list)
    """ms from a changed demand to the motors."""
    stops: list[float] = field(default_factory=list)
    """ms from the first disarm to motors without power."""
    tries: list[int] = field(default_factory=list)
    log: list[float] = field(default_factory=list)
    """Bytes/s of the log."""


def run(options: Options) -> Report:
    """Measure round by round, the floods in turn."""
    seen = {kind: Seen() for kind in (NOBODY, *FLOODS)}
    for turn in range(ROUNDS):
        for kind in seen:
            options.say(f"strangers: round {turn + 1} of {ROUNDS}, {kind}")
            _measure(seen[kind], kind, QUICK_WINDOW if options.quick else WINDOW)
    note = "CPU: 100 % is one core. stop: from the first disarm of a new ground station, repeated every 0.35 s."
    table = Table("mavhelm vehicle --sim under strangers", [_row(*each) for each in seen.items()], note)
    calm = f"{NOBODY}, {brief(max(seen[NOBODY].stops))} ms"
    goals = [
        Goal(f"stop under {kind}, worst", max(each.stops), 1000.0, "ms", reference=calm)
        for kind, each in seen.items()
        if kind != NOBODY
    ]
    return Report([table], goals)


def _measure(seen: Seen, kind: str, window: float) -> None:
    with _scene(kind) as (watch, vehicle, motors, driver, crowd, port):
        pids = family(vehicle.pid)
        cpu, log, started = cpu_seconds(pids), _written(vehicle), time.monotonic()
        while time.monotonic() - started < window:
            seen.demands.append(_change(watch, crowd, motors))
        spent = time.monotonic() - started
        seen.cpu.append(100 * (cpu_seconds(pids) - cpu) / spent)
        seen.log.append((_written(vehicle) - log) / spent)
        if not driver.armed:
            raise BenchmarkError(f"{kind}: the vehicle disarmed while it was driven")
        with closing(Light(watch, port, NEWCOMER)) as newcomer:
            took, tries = _stop(newcomer, crowd, motors)
        seen.stops.append(took)
        seen.tries.append(tries)


def _change(watch: Watch, crowd: Crowd, motors: MotorFeed) -> float:
    """Change the demand; return the ms until the motors change."""
    stamp = time.monotonic_ns()
    crowd.drive_at(Axes(throttle=0.9 if crowd.throttle < 0.7 else 0.5))
    change = motors.after(stamp, 2.0)
    if change is None:
        raise BenchmarkError("a changed demand did not reach the motors")
    crowd.pass_time(CHANGE)
    return (change.at - stamp) / 1e6


def _stop(newcomer: Light, crowd: Crowd, motors: MotorFeed) -> tuple[float, int]:
    """Disarm until the motors have no power; return the ms and the number of tries."""
    if not motors.moving:
        raise BenchmarkError("the motors did not turn before the stop")
    stamp = time.monotonic_ns()
    for tries in range(1, TRIES + 1):
        newcomer.say(m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, tries - 1, 0, 0, 0, 0, 0, 0, 0))
        crowd.pass_time(REPEAT_AFTER)
        if not motors.moving:
            return (motors.changes[-1].at - stamp) / 1e6, tries
    raise BenchmarkError(f"not stopped by {TRIES} disarms")


def _written(vehicle: Program) -> int:
    """Return the bytes that the vehicle has written so far to its log, which is stderr here."""
    return vehicle.received


@contextmanager
def _scene(kind: str) -> Iterator[tuple[Watch, Program, MotorFeed, Light, Crowd, int]]:
    with ExitStack() as stack:
        watch = stack.enter_context(closing(Watch()))
        folder = stack.enter_context(scratch())
        motors = stack.enter_context(closing(MotorFeed(watch, folder)))
        port = free_port()
        command = python("vehicle", "--sim", f"udpin:127.0.0.1:{port}", "--motor-log", str(motors.path))
        vehicle = on_pipe(watch, [*command, "--param", "MOT_SLEWRATE=1000", "--param", "FS_LOOP_TIMEOUT=2"])
        stack.callback(vehicle.end)
        vehicle.wait_for("ready", 20)
        driver = stack.enter_context(closing(Light(watch, port, DRIVER)))
        crowd = Crowd(watch, [driver])
        crowd.drive()
        crowd.pass_time(1.0)
        if kind != NOBODY:
            strangers = on_pipe(watch, python("tests.benchmarks.stranger_flood", kind, str(port)))
            stack.callback(strangers.end)
        crowd.pass_time(2.0)
        yield watch, vehicle, motors, driver, crowd, port


def _row(kind: str, seen: Seen) -> Row:
    ordered = sorted(seen.demands)
    return {
        "strangers": FLOODS[kind].what if kind in FLOODS else kind,
        "CPU %": median(seen.cpu),
        "demand to motor p50 ms": median(ordered),
        "worst ms": ordered[-1],
        "stop ms": median(seen.stops),
        "worst stop ms": max(seen.stops),
        "tries": " / ".join(map(str, seen.tries)),
        "log B/s": median(seen.log),
    }
