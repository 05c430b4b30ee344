"""One driven rover among other vehicles that are heard: key to motor, and the CPU time of the ground station."""

from __future__ import annotations

import math
import random
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from statistics import median

from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Row, Table, brief, spread
from tests.benchmarks.fleet_sender import RATE
from tests.benchmarks.key_to_motor import CONTENDERS, OURS_WIDE, Outcome, Rig, running
from tests.benchmarks.procfs import cpu_seconds, family
from tests.benchmarks.programs import on_pipe, python

OTHERS = (0, 15, 99)
"""Numbers of vehicles beside the driven one."""

KEYS, QUICK_KEYS = 40, 10
SETTLE = 3.0
"""s from the first messages of the others until all of them are known."""


@dataclass(slots=True)
class _Result:
    outcome: Outcome = field(default_factory=lambda: Outcome([]))
    cpu: list[float] = field(default_factory=list)


def run(options: Options) -> Report:
    """Measure each number of vehicles in turn, round by round."""
    chance = random.Random(7)
    results = {others: _Result() for others in OTHERS}
    for turn in range(ROUNDS):
        for others, result in results.items():
            options.say(f"fleet: round {turn + 1} of {ROUNDS}, {others} further vehicles")
            with running(CONTENDERS[OURS_WIDE]) as rig, _fleet(rig, others):
                rig.arm()
                rig.watch.pause(SETTLE)
                pids = family(rig.ground.pid)
                before, begun = cpu_seconds(pids), time.monotonic()
                with suppress(BenchmarkError):  # no key of this round came: all of them are counted as lost
                    rig.measure(result.outcome, QUICK_KEYS if options.quick else KEYS, chance)
                result.cpu.append(100 * (cpu_seconds(pids) - before) / (time.monotonic() - begun))
    return _report(results)


@contextmanager
def _fleet(rig: Rig, others: int) -> Iterator[None]:
    if not others:
        yield
        return
    fleet = on_pipe(rig.watch, python("tests.benchmarks.fleet_sender", str(others), str(rig.port)))
    try:
        fleet.wait_for("fleet ready", 20)
        yield
    finally:
        fleet.end()


def _report(results: dict[int, _Result]) -> Report:
    spreads = {others: spread(result.outcome.latencies or [[math.inf]]) for others, result in results.items()}
    rows: list[Row] = [
        {
            "further vehicles": others,
            "messages/s": others * RATE,
            "keys": spreads[others].samples,
            "lost": result.outcome.lost,
            "p50": spreads[others].p50,
            "p99": spreads[others].p99,
            "CPU %": median(result.cpu),
        }
        for others, result in results.items()
    ]
    note = "Key byte to motor outputs, ms, at 140x45. CPU: all processes of the ground station."
    most = OTHERS[-1]
    alone, crowded = spreads[OTHERS[0]], spreads[most]
    beside = f"the rover alone, {brief(alone.p99)} ms"
    goals = [
        Goal(f"key to motor among {most + 1} vehicles, p99", crowded.p99 / alone.p99, 4, "x", reference=beside),
        Goal(f"keys lost among {most + 1} vehicles", results[most].outcome.lost, 0, "keys"),
    ]
    return Report([Table("One driven rover among other vehicles", rows, note)], goals)
