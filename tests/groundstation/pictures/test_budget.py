"""Bytes a second on a slow line, in virtual time: frames are dropped first, then they are coarser, and fine again."""

from __future__ import annotations

from groundstation.pictures.budget import MIN_RATE, PONG_PATIENCE, ByteBudget
from groundstation.pictures.painters import MAX_LEVEL


class Line:
    """A line to a terminal of so many bytes a second; a frame has half of the bytes at each coarser level."""

    def __init__(self, budget: ByteBudget, speed: float, delay: float = 0.0) -> None:
        self.budget, self.speed, self.delay = budget, speed, delay
        self.now = 0.0
        self.sent: list[tuple[float, int]] = []
        self._pongs: list[float] = []

    def run(self, seconds: float, size: int) -> None:
        end = self.now + seconds
        while self.now < end:
            self.now += 0.01
            while self._pongs and self._pongs[0] <= self.now:
                self.budget.handle_pong(self._pongs.pop(0))
            if self.budget.may_draw(self.now):
                frame = size >> 2 * self.budget.level
                self.budget.note_frame(frame, self.now)
                self.sent.append((self.now, frame))
                self._pongs.append(self.now + self.delay + frame / self.speed)

    def bytes_since(self, time: float) -> int:
        return sum(size for at, size in self.sent if at >= time)


def test_the_limit_holds_and_frames_become_coarser() -> None:
    line = Line(ByteBudget(100_000), speed=1e9)
    line.run(20.0, 60_000)
    assert line.bytes_since(10.0) <= 1.05 * 100_000 * 10
    assert line.budget.level >= 1
    rate = sum(at >= 10.0 for at, _ in line.sent) / 10
    assert rate >= MIN_RATE


def test_one_frame_at_most_is_on_a_slow_line() -> None:
    line = Line(ByteBudget(8_000_000), speed=200_000)
    line.run(10.0, 400_000)
    times = [at for at, _ in line.sent]
    taken = [at + size / 200_000 for at, size in line.sent]
    assert all(begin + 0.02 >= read for begin, read in zip(times[1:], taken, strict=False))
    assert line.budget.level > 0


def test_frames_become_fine_again() -> None:
    budget = ByteBudget(1_000_000)
    line = Line(budget, speed=50_000)
    line.run(10.0, 60_000)
    assert budget.level > 0
    line.speed = 1e8
    line.run(20.0, 20_000)
    assert budget.level == 0


def test_a_far_terminal_is_no_slow_line() -> None:
    budget = ByteBudget(1_000_000, round_trip=0.4)
    Line(budget, speed=1e9, delay=0.4).run(10.0, 1000)
    assert budget.level == 0


def test_a_terminal_that_answers_nothing() -> None:
    for round_trip, gap in ((0.0, PONG_PATIENCE), (None, 0.1)):
        budget = ByteBudget(100_000, round_trip=round_trip)
        budget.note_frame(10_000, 0.0)
        assert not budget.may_draw(gap - 0.01)
        assert budget.may_draw(gap)


def test_the_coarsest_level_is_the_last() -> None:
    line = Line(ByteBudget(10_000), speed=1e9)
    line.run(60.0, 100_000)
    assert line.budget.level == MAX_LEVEL
