"""The order of the suite: tests that wait for programs are spread between those that compute.

In the order of their files the tests of real programs would all run at the same time, with idle processors, and later
those that compute, with busy ones. Mixed, they need two thirds of the time.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TypeVar

import pytest

Each = TypeVar("Each")

WAITING_MARKERS = ("e2e", "interop", "tmux", "slow", "xdist_group")
WAITING_FOLDERS = (
    "groundstation/verbs", "groundstation/connect", "groundstation/disk", "link/bridge", "vehicle/cli",
    "vehicle/motors",
)  # fmt: skip
"""Folders below tests/ whose tests start programs, talk to sockets or to a controller behind a line."""
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
    return list(spread(sorted(waiting, key=_is_short), sorted(computing, key=lambda item: not computes_long(item))))


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
    folder = item.path.parent.as_posix()
    return any(mark.name in WAITING_MARKERS for mark in item.iter_markers()) or folder.endswith(WAITING_FOLDERS)


def gives_way(item: pytest.Item) -> bool:
    """Return whether a test only computes: it is not late, however slowly it runs. A coroutine draws a screen."""
    return not waits(item) and not inspect.iscoroutinefunction(getattr(item, "obj", None))


def _is_short(item: pytest.Item) -> bool:
    """Return False for the slow tests, and for a group, which one worker runs from its first to its last test."""
    return item.get_closest_marker("slow") is None and item.get_closest_marker("xdist_group") is None


def computes_long(item: pytest.Item) -> bool:
    """Return whether a test is one of LONG."""
    return item.path.parent.as_posix().endswith(LONG) or item.path.as_posix().endswith(LONG)
