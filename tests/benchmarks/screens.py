"""Screens and panes: how long a screen takes to open, and key to motor with each pane of the Drive screen."""

from __future__ import annotations

import random
import time

from groundstation.screens import SCREENS
from groundstation.ui.panes import PANES
from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Row, Table, spread
from tests.benchmarks.key_to_motor import CONTENDERS, OURS_WIDE, Outcome, Rig, running

TITLES = {
    "map": "mission", "messages": "messages", "params": "parameters", "charts": "fields", "log": "alerts",
    "links": "who is in control", "setup": "doctor", "files": "logs on the vehicle", "connect": "heard now",
}  # fmt: skip
"""Id of a screen -> a title that its first picture has."""

GO_TO, DRIVE = b"\x07", b"\x1bOP"
CHANGES, QUICK_CHANGES = 10, 3
KEYS, QUICK_KEYS = 40, 10
SETTLE = 0.5
"""s after a screen was opened until the next one."""
WITHIN = 5.0


def run(options: Options) -> Report:
    """Measure the changes of the screen and the panes, round by round."""
    chance = random.Random(7)
    changes: dict[str, list[list[float]]] = {name: [] for name in TITLES}
    panes = {pane.id: Outcome([]) for pane in PANES}
    for number in range(ROUNDS):
        options.say(f"screens: round {number + 1} of {ROUNDS}")
        with running(CONTENDERS[OURS_WIDE]) as rig:
            rig.arm()
            for pane in PANES:
                rig.watch.pause(SETTLE)
                rig.measure(panes[pane.id], QUICK_KEYS if options.quick else KEYS, chance)
                rig.ground.type(b"v")
            for name in TITLES:
                times = [_change(rig, name) for _ in range(QUICK_CHANGES if options.quick else CHANGES)]
                changes[name].append(times[1:])  # the first one imports the module
    return _report(changes, panes)


def _change(rig: Rig, name: str) -> float:
    """Return the ms from the key to the first picture of the screen; go back to Drive."""
    digit = next(row.digit for row in SCREENS if row.id == name).encode()
    rig.ground.type(GO_TO)
    rig.watch.pause(SETTLE)
    before = rig.ground.received
    stamp = rig.ground.type(digit)
    if not rig.watch.until(lambda: TITLES[name] in rig.ground.text_since(before), WITHIN):
        raise BenchmarkError(f"the screen {name} did not open; it says {rig.ground.text_since(before)[-300:]!r}")
    took = (time.monotonic_ns() - stamp) / 1e6
    rig.ground.type(DRIVE)
    rig.watch.pause(SETTLE)
    return took


def _report(changes: dict[str, list[list[float]]], panes: dict[str, Outcome]) -> Report:
    opened = {name: spread(rounds) for name, rounds in changes.items()}
    driven = {name: spread(outcome.latencies) for name, outcome in panes.items()}
    rows: list[Row] = [
        {"screen": name, "opened": each.samples, "p50": each.p50, "max": each.max} for name, each in opened.items()
    ]
    lines: list[Row] = [
        {"pane": name, "keys": each.samples, "lost": panes[name].lost, "p50": each.p50, "p99": each.p99}
        for name, each in driven.items()
    ]
    first = driven[PANES[0].id]
    busiest = max(driven.values(), key=lambda each: each.p99)
    goals = [
        Goal("the slowest screen, key to first picture, p50", max(each.p50 for each in opened.values()), 100, "ms"),
        Goal("key to motor with the busiest pane / with the first one, p99", busiest.p99 / first.p99, 2, "x"),
    ]
    return Report(
        [
            Table("Key to the first picture of a screen, ms, at 140x45", rows, "Without the first time."),
            Table("Key byte to motor outputs with each pane of Drive, ms, at 140x45", lines),
        ],
        goals,
    )
