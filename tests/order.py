"""The order of the suite: tests that wait for programs are spread between those that compute.

In the order of their files the tests of real programs would all run at the same time, with idle processors, and later
those that compute, with busy ones. Mixed, they need two thirds of the time. CI runs each kind in a process of its own
(`--kind`): many workers wait, and two that compute take what these leave of the processors.
"""

from __future__ import annotations

import functools
import inspect
import re
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TypeVar

import pytest

Each = TypeVar("Each")

WAITING, COMPUTING = KINDS = ("waiting", "computing")

WAITING_MARKERS = ("e2e", "interop", "tmux", "slow", "xdist_group")
WAITING_FOLDERS = (
    "e2e", "interop", "groundstation/verbs", "groundstation/connect", "groundstation/disk", "link/bridge",
    "vehicle/cli", "vehicle/motors",
)  # fmt: skip
"""Folders below tests/ whose tests, those of their rooms too, start programs, talk to sockets or to a controller behind
a line."""
MARKED = re.compile(r"\bmark\.(e2e|interop|tmux|slow|xdist_group)\b|\bIN_TMUX\b")
"""What a file has in which a test has one of WAITING_MARKERS."""
GROUPS = (
    "agents", "browser", "programs", "fleet", "verbs through a station", "strangers", "forked programs",
    "verbs with our vehicle", "systemd", "fleet networks", "mavsdk_vehicle",
)  # fmt: skip
"""Groups that one worker runs for a minute and more, the longest first: the last one to begin would run alone."""
LONG = (
    "tests/vehicle/machine", "tests/vehicle/autonomy/mission", "tests/test_stops.py", "tests/test_stop_monkey.py",
    "tests/test_stop_worlds.py",
)  # fmt: skip
"""Folders and files with tests that compute for 10 to 50 s: at the end, one of them would run alone."""
LAST = 0.85
"""Share of the suite by which the last waiting test has begun: a long one at the end would run alone."""


def mix(items: Sequence[pytest.Item]) -> list[pytest.Item]:
    """Return all items, in their order but for those that wait, which are spread; the longest of both come first."""
    waiting: list[pytest.Item] = []
    computing: list[pytest.Item] = []
    for item in items:
        (waiting if waits(item) else computing).append(item)
    return list(spread(sorted(waiting, key=_place), sorted(computing, key=lambda item: not computes_long(item))))


def of_kind(items: Sequence[pytest.Item], kind: str) -> tuple[list[pytest.Item], list[pytest.Item]]:
    """Return the items of a kind, and the others."""
    ours = [waits(item) == (kind == WAITING) for item in items]
    pairs = list(zip(items, ours, strict=True))
    return [item for item, our in pairs if our], [item for item, our in pairs if not our]


def has_none(path: Path, kind: str) -> bool:
    """Return whether a file has no test of a kind, so that it need not be imported: that takes 15 s for all files."""
    if _in_waiting_folder(path):
        return kind == COMPUTING
    return kind == WAITING and not MARKED.search(path.read_text())


def left_out(items: Sequence[pytest.Item]) -> list[Path]:
    """Return the files of items which has_none would keep from being imported for the kind of the item."""
    kinds = {(item.path, WAITING if waits(item) else COMPUTING) for item in items}
    return sorted(path for path, kind in kinds if has_none(path, kind))


def spread(few: Sequence[Each], many: Sequence[Each]) -> Iterator[Each]:
    """Yield one of `few` and then its share of `many`, the rest of `many` at the end."""
    share = LAST * len(many) / max(1, len(few))
    cuts = [round(number * share) for number in range(len(few))] + [len(many)]
    yield from many[: cuts[0]]
    for item, (start, end) in zip(few, pairwise(cuts), strict=True):
        yield item
        yield from many[start:end]


def waits(item: pytest.Item) -> bool:
    """Return whether a test starts programs, waits in real time, or is long."""
    return any(mark.name in WAITING_MARKERS for mark in item.iter_markers()) or _in_waiting_folder(item.path)


def gives_way(item: pytest.Item) -> bool:
    """Return whether a test only computes: it is not late, however slowly it runs. A coroutine draws a screen."""
    return not waits(item) and not inspect.iscoroutinefunction(getattr(item, "obj", None))


def _place(item: pytest.Item) -> int:
    """Return the place of a group in GROUPS; behind these come the other groups and the slow tests, then all others."""
    group = item.get_closest_marker("xdist_group")
    if group and group.args[0] in GROUPS:
        return GROUPS.index(group.args[0])
    return len(GROUPS) + (group is None and item.get_closest_marker("slow") is None)


@functools.cache
def _in_waiting_folder(path: Path) -> bool:
    return any(f"/tests/{folder}/" in path.as_posix() for folder in WAITING_FOLDERS)


def computes_long(item: pytest.Item) -> bool:
    """Return whether a test is one of LONG."""
    return item.path.parent.as_posix().endswith(LONG) or item.path.as_posix().endswith(LONG)
