"""Snapshots come five times a second, twice while the station rests, and in the next slot if a driver must see them."""

from __future__ import annotations

from collections.abc import Hashable
from itertools import pairwise

from groundstation.host.snapshot_pace import CALLS_AT_REST, LIVELY, REST_PERIOD, SLOT, STEADY_PERIOD, SnapshotPace


class Clock:
    """Calls a pace as often as the station does, a little early or late."""

    def __init__(self) -> None:
        self.pace = SnapshotPace()
        self.now = 100.0
        self._count = 0

    def run(self, seconds: float, *, rests: bool, urgent_state: Hashable = 0) -> list[float]:
        """Return when snapshots were due."""
        sent = []
        for _ in range(round(seconds / SLOT)):
            self._count += 1
            self.now = 100.0 + self._count * SLOT + (0.003 if self._count % 2 else 0.0)
            if self.pace.is_due(self.now, rests=rests, urgent_state=urgent_state):
                sent.append(self.now)
        return sent


def test_every_second_call_is_due_while_something_is_under_way() -> None:
    sent = Clock().run(5.0, rests=False)
    assert len(sent) == 25
    assert max(later - earlier for earlier, later in pairwise(sent)) < STEADY_PERIOD + SLOT / 2


def test_every_fifth_call_is_due_at_rest() -> None:
    sent = Clock().run(6.0, rests=True)
    assert 12 <= len(sent) <= 15, "it is lively at the start"
    assert max(later - earlier for earlier, later in pairwise(sent)) < REST_PERIOD + SLOT


def test_calls_are_few_at_rest_once_nothing_happened_for_a_while() -> None:
    clock = Clock()
    clock.run(0.5, rests=True)
    assert clock.pace.call_period(clock.now, rests=True) == SLOT
    clock.run(LIVELY + SLOT, rests=True)
    assert clock.pace.call_period(clock.now, rests=True) == CALLS_AT_REST
    assert clock.pace.call_period(clock.now, rests=False) == SLOT


def test_the_end_of_a_rest_shows_within_the_steady_period() -> None:
    clock = Clock()
    clock.run(2.5, rests=True)
    assert clock.run(0.3, rests=False)[0] - clock.now < 0


def test_what_a_driver_must_see_shows_in_the_next_call_each_time() -> None:
    clock = Clock()
    clock.run(2.5, rests=False)
    assert len([each for each in range(1, 21) if clock.run(SLOT, rests=False, urgent_state=each)]) == 20
    assert len(clock.run(5.0, rests=False, urgent_state=20)) == 25


def test_what_a_screen_has_done_ends_the_rest_for_a_while() -> None:
    clock = Clock()
    clock.run(2.5, rests=True)
    clock.pace.note(clock.now)
    assert len(clock.run(LIVELY, rests=True)) >= 5
    assert len(clock.run(3.0, rests=True)) <= 6


def test_a_new_log_line_is_in_the_next_call_and_ends_the_rest() -> None:
    clock = Clock()
    clock.run(2.5, rests=True, urgent_state=4)
    (first, *_) = clock.run(0.3, rests=True, urgent_state=5)
    assert first == clock.now - 2 * SLOT or clock.now - first > 1.5 * SLOT
    assert len(clock.run(LIVELY, rests=True, urgent_state=5)) >= 4
