"""The real vehicle with a tenth of a core: control cycles, keys, failsafes, beside the same vehicle with a whole one.

The rest (ground station, driver, kernel) has the whole machine, and the vehicle its part before all others (niceness
-20). What limits it is in cpu_quota.py. It starts with a whole core: how long a start takes is measured by `cost`.
"""

from __future__ import annotations

import math
import random
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median

from tests.benchmarks.cpu_quota import Limit, favour, kernel_quota, slices, whole_core
from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Row, Table, brief, spread
from tests.benchmarks.key_to_motor import CONTENDERS, OURS_NARROW, Outcome, running
from tests.benchmarks.loop_lateness import Driver, lateness
from tests.benchmarks.procfs import cpu_seconds
from tests.benchmarks.programs import Program, free_port, on_pipe, python, scratch
from tests.benchmarks.ticking import PERIOD, read
from tests.benchmarks.watch import Watch

SECONDS, QUICK_SECONDS = 5.0, 2.0
"""s of driving in one round under one limit."""
KEYS, QUICK_KEYS = 40, 14
"""Keys in one round under one limit."""
PACE = (0.1, 0.4)
"""s, random, from settled outputs to the next key: the keys of a driver are part of the load."""
SETTLE = 0.3
"""s from the beginning of a limit until cycles count."""
LATE, KEY_LATE = 5.0, 20.0
"""ms at p99: the goals."""
WHOLE, QUOTA, SLICES = "a whole core", "1 ms in 10 ms (quota of the kernel)", "0.5 ms in 5 ms (stopped between)"
LIMITS: dict[str, Limit] = {WHOLE: whole_core, QUOTA: kernel_quota, SLICES: slices}


@dataclass(slots=True)
class Seen:
    """Results under one limit; a value or a list for each round."""

    late: list[list[float]] = field(default_factory=list)
    """ms."""
    cycles: int = 0
    due: float = 0.0
    """Cycles that a rate of 50 Hz has in the same time."""
    cpu: list[float] = field(default_factory=list)
    """% of a core."""
    keys: Outcome = field(default_factory=lambda: Outcome([]))
    failsafes: int = 0
    """Lines about failsafes in the log of the vehicle."""
    stops: int = 0
    """Rounds at whose end it no longer drove."""


def run(options: Options) -> Report:
    """Measure under each limit in turn, round by round."""
    seen = {name: Seen() for name in LIMITS}
    chance = random.Random(13)
    for turn in range(ROUNDS):
        for name, limit in LIMITS.items():
            options.say(f"tenth_core: round {turn + 1} of {ROUNDS}, {name}")
            _drive(seen[name], limit, QUICK_SECONDS if options.quick else SECONDS)
            _press(seen[name], limit, QUICK_KEYS if options.quick else KEYS, chance)
    return _report(seen)


def _drive(seen: Seen, limit: Limit, seconds: float) -> None:
    """Drive at a steady speed, and record when the control cycles reach the motors."""
    with scratch() as folder, _vehicle(folder) as (vehicle, driver), limit(vehicle.pid) as begin:
        favour(vehicle.pid)
        driver.arm(folder / "stamps")
        begin()
        driver.drive(SETTLE)
        before, cpu, began = len(read(folder / "stamps")), cpu_seconds([vehicle.pid]), time.monotonic()
        driver.drive(seconds)
        spent = time.monotonic() - began
        seen.cpu.append(100 * (cpu_seconds([vehicle.pid]) - cpu) / spent)
        stamps = read(folder / "stamps")[before:]
        seen.cycles += len(stamps)
        seen.due += spent / PERIOD
        seen.failsafes += _failsafes(vehicle)
        if len(stamps) < spent / PERIOD / 2:  # a vehicle that is disarmed does not set its motors
            seen.stops += 1
        else:
            seen.late.append(lateness(stamps))


@contextmanager
def _vehicle(folder: Path) -> Iterator[tuple[Program, Driver]]:
    port, watch = free_port(), Watch()
    config = folder / "rover.toml"
    config.write_text(
        f'endpoints = ["udpin:127.0.0.1:{port}"]\nstate = "{folder}/state"\n'
        f'[motors]\ndriver = "tests.benchmarks.ticking:Motors"\nstamps = "{folder}/stamps"\n'
    )
    vehicle = on_pipe(watch, python("vehicle", "--config", str(config)))
    try:
        vehicle.wait_for("ready", 20)
        with Driver(port, watch) as driver:
            yield vehicle, driver
    finally:
        vehicle.end()
        watch.close()


def _press(seen: Seen, limit: Limit, keys: int, chance: random.Random) -> None:
    """Press keys in the ground station, each of which must change the outputs of a simulated vehicle."""
    with running(CONTENDERS[OURS_NARROW]) as rig, limit(rig.vehicle.pid) as begin:
        favour(rig.vehicle.pid)
        rig.arm()
        begin()
        rig.watch.pause(SETTLE)
        try:
            rig.measure(seen.keys, keys, chance, PACE)
        except BenchmarkError:
            seen.stops += 1
        seen.failsafes += _failsafes(rig.vehicle)


def _failsafes(vehicle: Program) -> int:
    return sum("failsafe" in line.lower() for line in vehicle.text.splitlines())


# ---- report ----


def _report(seen: dict[str, Seen]) -> Report:
    note = (
        "`late`: control cycles at 50 Hz against the earliest of the round. `key`: from a byte written to the terminal "
        "at 80x24 until the outputs change. `failsafes`: lines in the log of the vehicle. `stopped`: parts of a round "
        "in which it did not drive on."
    )
    goals: list[Goal] = []
    whole = seen[WHOLE]
    for name in (QUOTA, SLICES):
        for what, measured, limit, unit, reference in (
            ("control cycle late, p99", _p99(seen[name].late), LATE, "ms", _p99(whole.late)),
            ("key to motor, p99", _p99(seen[name].keys.latencies), KEY_LATE, "ms", _p99(whole.keys.latencies)),
            ("failsafes and stops", seen[name].failsafes + seen[name].stops, 0, "", whole.failsafes + whole.stops),
            ("keys lost", seen[name].keys.lost, 0, "keys", whole.keys.lost),
        ):
            beside = f"{WHOLE}, {brief(reference)} {unit}".rstrip()
            goals.append(Goal(f"{name}: {what}", measured, limit, unit, reference=beside))
    return Report([Table("Vehicle with a tenth of a core, ms", [_row(*each) for each in seen.items()], note)], goals)


def _p99(rounds: list[list[float]]) -> float:
    return spread(rounds).p99 if rounds else math.inf


def _row(name: str, seen: Seen) -> Row:
    row: Row = {"vehicle has": name, "cycles/s": seen.cycles / seen.due / PERIOD, "CPU %": median(seen.cpu)}
    if seen.late:
        late = spread(seen.late)
        row |= {"late p50": late.p50, "late p99": late.p99, "late max": late.max}
    if seen.keys.latencies:
        key = spread(seen.keys.latencies)
        row |= {"keys": key.samples, "key p50": key.p50, "key p99": key.p99, "key max": key.max}
    return row | {"keys lost": seen.keys.lost, "failsafes": seen.failsafes, "stopped": seen.stops}
