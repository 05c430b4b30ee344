"""Snapshots come ten times a second while something may change, twice while the station rests."""

from __future__ import annotations

from itertools import pairwise

from groundstation.host.snapshot_pace import LIVELY, REST_PERIOD, SNAPSHOT_PERIOD, SnapshotPace


class Clock:
    """Calls a pace as often as the station does, a little early or late."""

    def __init__(self) -> None:
        self.pace = SnapshotPace()
        self.now = 100.0
        self._count = 0

    def run(self, seconds: float, *, rests: bool, log_state: int = 0) -> list[float]:
        """Return when snapshots were due."""
        sent = []
        for _ in range(round(seconds / SNAPSHOT_PERIOD)):
            self._count += 1
            self.now = 100.0 + self._count * SNAPSHOT_PERIOD + (0.003 if self._count % 2 else 0.0)
            if self.pace.is_due(self.now, rests=rests, log_state=log_state):
                sent.append(self.now)
        return sent


def test_each_call_is_due_while_something_is_under_way() -> None:
    assert len(Clock().run(5.0, rests=False)) == 50


def test_every_fifth_call_is_due_at_rest() -> None:
    sent = Clock().run(6.0, rests=True)
    assert len(sent) == 12
    assert max(later - earlier for earlier, later in pairwise(sent)) < REST_PERIOD + SNAPSHOT_PERIOD


def test_the_end_of_a_rest_shows_in_the_next_call() -> None:
    clock = Clock()
    clock.run(1.1, rests=True)
    assert len(clock.run(0.3, rests=False)) == 3


def test_what_a_screen_has_done_shows_at_the_fast_rate_for_a_while() -> None:
    clock = Clock()
    clock.run(1.1, rests=True)
    clock.pace.note(clock.now)
    assert len(clock.run(LIVELY, rests=True)) == 10
    assert len(clock.run(3.0, rests=True)) <= 6


def test_a_new_line_of_the_log_shows_in_the_next_call() -> None:
    clock = Clock()
    clock.run(1.1, rests=True, log_state=4)
    clock.run(LIVELY + 0.2, rests=True, log_state=4)
    assert len(clock.run(0.3, rests=True, log_state=5)) == 3
