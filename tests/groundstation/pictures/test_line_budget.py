"""Pictures on a line that carries keys' effects, too: a line of so many bytes a second in virtual time."""

from __future__ import annotations

import pytest

from groundstation.pictures.line_budget import FIRST_ROOM, FRAME_TIME, LineBudget

FINE = 150_000
"""Bytes of a picture at level 0; each level has half of the one before."""
COARSEST = 4
STEP = 0.01


class Line:
    """A terminal line; `round_trip` is that of a few bytes."""

    def __init__(self, rate: float, limit: int = 8_000_000, round_trip: float = 0.01) -> None:
        self.budget, self.rate, self.round_trip = LineBudget(limit), rate, round_trip
        self.now = 0.0
        self.levels: list[int] = []
        self.times: list[float] = []
        self.sent = 0
        self._read_at: float | None = None
        self._took = 0.0

    @staticmethod
    def size(level: int) -> int:
        return FINE >> level

    def live(self, seconds: float) -> None:
        end = self.now + seconds
        while self.now < end:
            self.now += STEP
            if self._read_at is not None and self.now >= self._read_at:
                self._read_at = None
                self.budget.note_read(self._took, self.round_trip)
            if self._read_at is None and self.budget.may_draw(self.now):
                self._draw()

    def _draw(self) -> None:
        level = self.budget.choose_level(self.size, COARSEST, self.now)
        size = self.size(level)
        self.budget.note_frame(size, self.now)
        self._took = size / self.rate + self.round_trip
        self._read_at = self.now + self._took
        self.levels.append(level)
        self.times.append(self._took)
        self.sent += size


def test_nothing_known_means_a_small_picture() -> None:
    line = Line(200_000)
    line.live(0.05)
    assert line.levels == [COARSEST]
    assert line.size(COARSEST) < FIRST_ROOM


def test_a_fast_line_gets_fine_pictures_within_a_second() -> None:
    line = Line(50_000_000)
    line.live(1.5)
    assert line.levels[-1] == 0


@pytest.mark.parametrize("rate", [200_000, 100_000])
def test_a_slow_line_is_never_full_for_long(rate: int) -> None:
    line = Line(rate)
    line.live(20.0)
    assert max(line.times) < 1.4 * FRAME_TIME + line.round_trip
    assert line.sent < 0.85 * rate * 20  # the rest is for what keys change
    assert 0 < line.levels[-1] <= COARSEST


def test_a_line_that_becomes_slow_gets_coarser_pictures_at_once() -> None:
    line = Line(50_000_000)
    line.live(3.0)
    line.rate = 200_000
    line.live(3.0)
    assert line.levels[-1] > 0
    assert sum(each > 1.4 * FRAME_TIME + line.round_trip for each in line.times) == 1
    line.rate = 50_000_000
    line.live(5.0)
    assert line.levels[-1] == 0


def test_bytes_a_second_are_bounded_by_the_limit() -> None:
    line = Line(50_000_000, limit=250_000)
    line.live(20.0)
    assert line.sent < 250_000 * 20.5


def test_a_terminal_that_answers_nothing_gets_few_pictures() -> None:
    budget = LineBudget(8_000_000)
    drawn = []
    for hundredth in range(1000):
        now = hundredth / 100
        if budget.may_draw(now):
            drawn.append(budget.choose_level(Line.size, COARSEST, now))
            budget.note_frame(Line.size(drawn[-1]), now)
    assert len(drawn) == 10
    assert set(drawn) == {COARSEST}
