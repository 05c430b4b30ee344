"""Screens and panes: how long a screen takes to open, and key to motor with each pane of the Drive screen."""

from __future__ import annotations

import random
import time
from statistics import median

from groundstation.screens import SCREENS
from groundstation.ui.drive.panes import PANES
from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Row, Table, brief, spread
from tests.benchmarks.key_to_motor import CONTENDERS, OURS_WIDE, Outcome, Rig, running

TITLES = {
    "map": "─ mission ", "messages": "messages", "params": "parameters", "charts": "fields", "log": "alerts",
    "links": "who is in control", "setup": "doctor", "files": "logs on the vehicle", "connect": "heard now",
    "replay": "logs here",
}  # fmt: skip
"""Id of a screen -> a title that its first picture has."""

GO_TO, DRIVE = b"\x07", b"\x1bOP"
MENU_TITLE, DRIVE_TITLE = "go to", "motion"
CHANGES, QUICK_CHANGES = 5, 2
"""Openings of each screen in each round, with the first one."""
KEYS, QUICK_KEYS = 40, 8
"""Keys for each pane in each round: of 120 the second longest is the p99."""
SETTLE = 0.15
"""s from a picture to the next key: a drawing of the last snapshot, and half a snapshot's period."""
WITHIN = 5.0


def run(options: Options) -> Report:
    """Measure the changes of the screen and the panes, round by round."""
    chance = random.Random(7)
    changes: dict[str, list[list[float]]] = {name: [] for name in TITLES}
    firsts: dict[str, list[float]] = {name: [] for name in TITLES}
    panes = {pane.id: Outcome([]) for pane in PANES}
    for turn in range(ROUNDS):
        options.say(f"screens: round {turn + 1} of {ROUNDS}")
        with running(CONTENDERS[OURS_WIDE]) as rig:
            rig.arm()
            for pane in PANES:
                rig.watch.pause(SETTLE)
                rig.measure(panes[pane.id], QUICK_KEYS if options.quick else KEYS, chance)
                rig.ground.type(b"v")
            for name in TITLES:
                times = [_change(rig, name) for _ in range(QUICK_CHANGES if options.quick else CHANGES)]
                firsts[name].append(times[0])  # it imports the module
                changes[name].append(times[1:])
    return _report(firsts, changes, panes)


def _change(rig: Rig, name: str) -> float:
    """Return the ms from the key to the first picture of the screen; go back to Drive."""
    digit = next(row.digit for row in SCREENS if row.id == name).encode()
    _press(rig, GO_TO, MENU_TITLE)
    took = _press(rig, digit, TITLES[name])
    _press(rig, DRIVE, DRIVE_TITLE)
    return took


def _press(rig: Rig, key: bytes, title: str) -> float:
    """Return the ms from the key to a picture with this title."""
    rig.watch.pause(SETTLE)
    before = rig.ground.received
    stamp = rig.ground.type(key)
    if not rig.watch.until(lambda: title in rig.ground.text_since(before), WITHIN):
        raise BenchmarkError(f"no {title!r} after the key {key!r}; it says {rig.ground.text_since(before)[-300:]!r}")
    return (time.monotonic_ns() - stamp) / 1e6


def _report(firsts: dict[str, list[float]], changes: dict[str, list[list[float]]], panes: dict[str, Outcome]) -> Report:
    opened = {name: spread(rounds) for name, rounds in changes.items()}
    driven = {name: spread(outcome.latencies) for name, outcome in panes.items()}
    rows: list[Row] = [
        {"screen": name, "opened": each.samples, "p50": each.p50, "max": each.max, "first": median(firsts[name])}
        for name, each in opened.items()
    ]
    lines: list[Row] = [
        {
            "pane": name,
            "keys": each.samples,
            "lost": panes[name].lost,
            "p50": each.p50,
            "p90": each.p90,
            "p99": each.p99,
            "max": each.max,
        }
        for name, each in driven.items()
    ]
    first = driven[PANES[0].id]
    busiest = max(driven.values(), key=lambda each: each.p99)
    slowest = max(opened, key=lambda name: opened[name].p50)
    goals = [
        Goal(f"key to first picture of the slowest screen, {slowest}, p50", opened[slowest].p50, 100, "ms"),
        Goal(
            "key to motor with the busiest pane, p99",
            busiest.p99 / first.p99,
            2,
            "x",
            reference=f"first pane, {brief(first.p99)} ms",
        ),
        Goal("keys lost with all panes", sum(each.lost for each in panes.values()), 0, "keys"),
    ]
    return Report(
        [
            Table(
                "Key to the first picture of a screen, ms, at 140x45",
                rows,
                "first: the first time, which imports the module; p50 and max are without it.",
            ),
            Table("Key byte to motor outputs with each pane of Drive, ms, at 140x45", lines),
        ],
        goals,
    )
