"""When a link is cut on purpose: while the wheels turn, so that each cut is seen."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

from link.transport.faults.link_cut import LinkCut
from link.transport.faults.settings import CUT_AFTER

CYCLE = 0.02


def cut_times(cut: LinkCut, turning: Callable[[float], bool], seconds: float) -> list[float]:
    """Drive for so long, and return the times at which the links are cut."""
    found = []
    for step in range(int(seconds / CYCLE)):
        now = 100 + step * CYCLE
        cut.update(turning(now - 100), now)
        if cut.active(now):
            found.append(round(now - 100, 2))
    return found


def test_a_cut_begins_once_the_wheels_have_turned() -> None:
    times = cut_times(LinkCut(1.0), lambda now: 1.0 <= now < 4.0, 10)
    assert abs(times[0] - 1.0 - CUT_AFTER) <= 2 * CYCLE
    assert abs(times[-1] - times[0] - 1.0) <= 2 * CYCLE


def test_each_drive_is_cut_once_more() -> None:
    times = cut_times(LinkCut(0.5), lambda now: True, 5.2)
    gaps = [b - a for a, b in pairwise(times) if b - a > 2 * CYCLE]
    assert len(gaps) == 1
    assert abs(gaps[0] - CUT_AFTER) <= 3 * CYCLE


def test_short_drives_and_no_cut_asked_for_cut_nothing() -> None:
    assert cut_times(LinkCut(1.0), lambda now: now % 2.0 < CUT_AFTER - 0.5, 20) == []
    assert cut_times(LinkCut(0.0), lambda now: True, 20) == []
