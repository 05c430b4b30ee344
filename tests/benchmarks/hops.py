"""Where the time of a key goes: timestamps in all three programs, with each pane of Drive, beside a bare pair.

The load of the machine is kept out where the system allows it (root): the measured processes run before all others
(SCHED_FIFO), and keys are put into the queue of the terminal (TIOCSTI). That leaves out the kernel's worker that
moves bytes between the ends of a pty: on a busy machine it is late by up to 40 ms, for every program. The timestamps
are those of traced/sitecustomize.py.
"""

from __future__ import annotations

import fcntl
import os
import random
import termios
import time
from bisect import bisect_left
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from groundstation.ui.drive.panes import PANES
from tests.benchmarks.figures import BenchmarkError, Goal, Options, Report, Row, Spread, Table, brief, spread
from tests.benchmarks.key_to_motor import BARE, CONTENDERS, LOST_AFTER, OURS_WIDE, Outcome, Rig, running
from tests.benchmarks.machine import ROOT
from tests.benchmarks.procfs import family
from tests.benchmarks.programs import Program, scratch

KEYS, QUICK_KEYS = 60, 12
"""Keys for each pane."""
SETTLE = 0.3
"""s from the key that changes the pane to the next one."""
PRIORITY = 10

HOPS = (
    ("woken", "terminal to the input thread of the screen"),
    ("read", "read from the terminal"),
    ("gate", "parsed to keys"),
    ("sent", "key gate, packet to the station"),
    ("piped", "the station is woken"),
    ("decoded", "packet decoded"),
    ("encoded", "driving rules, demand encoded"),
    ("arrived", "UDP, the vehicle is woken"),
    ("motors", "frame, checks, ramps, motors"),
)
"""Timestamp -> what ends with it; the last one is the vehicle's own in its motor log."""


@dataclass(slots=True)
class Trace:
    """The timestamps of one run, ns, by name; rising."""

    stamps: dict[str, list[int]] = field(default_factory=dict)

    @classmethod
    def load(cls, folder: Path) -> Trace:
        """Read the files of all processes."""
        trace = cls()
        for file in folder.iterdir():
            for line in file.read_text().splitlines():
                at, _, name = line.split()
                trace.stamps.setdefault(name, []).append(int(at))
        for each in trace.stamps.values():
            each.sort()
        return trace

    def follow(self, pressed: int, changed: int) -> list[float] | None:
        """Return the ms of each hop of one key; None if it was not the key that changed the motors."""
        times, now = list[int](), pressed
        for name, _ in HOPS[:-1]:
            stamps = self.stamps.get(name, [])
            index = bisect_left(stamps, now)
            if index == len(stamps) or stamps[index] > changed:
                return None
            times.append(now := stamps[index])
        ends = [pressed, *times, changed]
        return [(later - earlier) / 1e6 for earlier, later in pairwise(ends)]


def run(options: Options) -> Report:
    """Press keys with each pane, each beside one of the bare pair."""
    chance = random.Random(7)
    totals: dict[str, Outcome] = {pane.id: Outcome([[]]) for pane in PANES} | {BARE: Outcome([[]])}
    pressed: list[tuple[int, int]] = []
    with scratch() as folder, ExitStack() as stack:
        with _tracing(folder):
            ours = stack.enter_context(running(CONTENDERS[OURS_WIDE]))
        bare = stack.enter_context(running(CONTENDERS[BARE]))
        ours.arm()
        alone = stack.enter_context(_before_all_others(ours, bare))
        for pane in PANES:
            options.say(f"hops: pane {pane.id}")
            for count in range(QUICK_KEYS if options.quick else KEYS):
                ours.settle(chance)
                pressed += _press(ours, count, totals[pane.id])
                bare.watch.pause(chance.uniform(0.02, 0.1))
                _press(bare, count, totals[BARE])
            ours.ground.type(b"v")
            ours.watch.pause(SETTLE)
        stack.close()
        trace = Trace.load(folder)
    found = [hops for each in pressed if (hops := trace.follow(*each)) is not None]
    if not found:
        raise BenchmarkError("no key was seen at every hop")
    return _report(totals, found, alone=alone)


def _press(rig: Rig, count: int, outcome: Outcome) -> list[tuple[int, int]]:
    """Press a key that changes the motors; return when it was pressed and when they changed, ns."""
    keys = rig.next_keys()
    stamp = _inject(rig.ground, keys[count // 2 % len(keys)])
    change = rig.feed.after(stamp, LOST_AFTER)
    if change is None:
        outcome.lost += 1
        return []
    outcome.latencies[0].append((change.at - stamp) / 1e6)
    return [(stamp, change.at)]


def _inject(program: Program, key: bytes) -> int:
    """Put a key into the queue of a terminal, or write it to the other end of the pty; return the time before."""
    with suppress(OSError):
        terminal = os.open(os.readlink(f"/proc/{program.pid}/fd/0"), os.O_RDWR | os.O_NOCTTY)
        try:
            stamp = time.monotonic_ns()
            fcntl.ioctl(terminal, termios.TIOCSTI, key)
            return stamp
        finally:
            os.close(terminal)
    return program.type(key)


@contextmanager
def _tracing(folder: Path) -> Iterator[None]:
    """Let programs that are started within the block write timestamps into a folder."""
    hooks = ROOT / "tests" / "benchmarks" / "traced"
    added = {"MAVHELM_BENCH_HOPS": str(folder), "PYTHONPATH": f"{hooks}{os.pathsep}{ROOT}"}
    before = {name: os.environ.get(name) for name in added}
    os.environ.update(added)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextmanager
def _before_all_others(*rigs: Rig) -> Iterator[bool]:
    """Run the programs and this process before all others of the machine; yields whether that is allowed."""
    threads = [
        int(thread)
        for rig in rigs
        for program in (rig.ground, rig.vehicle)
        for pid in family(program.pid)
        for thread in os.listdir(f"/proc/{pid}/task")
    ]
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY + 1))
        for thread in threads:
            os.sched_setscheduler(thread, os.SCHED_FIFO, os.sched_param(PRIORITY))
    except PermissionError:
        yield False
        return
    try:
        yield True
    finally:
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


# ---- report ----


def _report(totals: Mapping[str, Outcome], hops: list[list[float]], *, alone: bool) -> Report:
    spreads = {name: spread(outcome.latencies) for name, outcome in totals.items()}
    bare, mine = spreads[BARE], max((spreads[pane.id] for pane in PANES), key=lambda each: each.p99)
    p50, p99 = f"bare pair, {brief(bare.p50)} ms", f"bare pair, {brief(bare.p99)} ms"
    shown = [_row("hop", text, spread([[each[at] for each in hops]])) for at, (_, text) in enumerate(HOPS)]
    panes = [
        _row("pane", name, each) | {"keys": each.samples, "lost": totals[name].lost} for name, each in spreads.items()
    ]
    how = "before all other processes" if alone else "beside all other processes, whose load is part of the figures"
    return Report(
        [
            Table("A key on its way, ms, at 140x45", shown, f"{len(hops)} keys of all panes, {how}."),
            Table("Key to motor with each pane of Drive, ms, at 140x45", panes),
        ],
        [
            Goal(
                "before all others: pane with the longest p99 / bare pair, p50", mine.p50 / bare.p50, 2, "x", False, p50
            ),
            Goal("the same, p99", mine.p99 / bare.p99, 3, "x", False, p99),
        ],
    )


def _row(title: str, name: str, each: Spread) -> Row:
    return {title: name, "p50": each.p50, "p90": each.p90, "p99": each.p99, "max": each.max}
