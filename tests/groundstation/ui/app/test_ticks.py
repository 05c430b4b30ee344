"""Ticks of a real loop: at the multiples of the period, until they are stopped or fail."""

from __future__ import annotations

import asyncio

from groundstation.ui.app.ticks import Ticks
from tests.waits import PATIENCE

PERIOD = 0.01


class Run:
    """Ticks in a loop of their own, which runs until `done` is called."""

    def __init__(self) -> None:
        self.errors: list[Exception] = []
        self.times: list[float] = []

    def note(self) -> None:
        """Take a tick; the fifth is the last."""
        self.times.append(self.loop.time())
        if len(self.times) == 5:
            self.done()

    def fail(self, error: Exception) -> None:
        """Take an exception; the run ends."""
        self.errors.append(error)
        self.done()

    def done(self) -> None:
        """End the run; a tick that was stopped would come within three periods."""
        self.loop.call_later(3 * PERIOD, self._ended.set)

    def run(self, ticks: Ticks) -> None:
        """Start the ticks and wait for the end."""
        asyncio.run(self._run(ticks))

    async def _run(self, ticks: Ticks) -> None:
        self.loop, self._ended = asyncio.get_running_loop(), asyncio.Event()
        ticks.start(self.loop)
        await asyncio.wait_for(self._ended.wait(), PATIENCE)
        ticks.stop()


def test_each_tick_comes_after_another_multiple_of_the_period() -> None:
    run = Run()
    run.run(Ticks(PERIOD, run.note, run.fail))
    assert not run.errors
    assert len({(at + PERIOD / 100) // PERIOD for at in run.times}) == len(run.times) >= 5


def test_stopped_by_its_own_call_it_is_not_called_again() -> None:
    run = Run()

    def call() -> None:
        run.note()
        ticks.stop()
        run.done()

    ticks = Ticks(PERIOD, call, run.fail)
    run.run(ticks)
    assert len(run.times) == 1


def test_an_exception_ends_it_and_is_handed_over() -> None:
    run = Run()

    def call() -> None:
        raise ValueError("broken")

    run.run(Ticks(PERIOD, call, run.fail))
    assert [str(error) for error in run.errors] == ["broken"]


def test_shorter_period_counts_at_once_and_longer_one_next_tick() -> None:
    run = Run()

    def call() -> None:
        run.note()
        ticks.set_period(2 * PERIOD)

    ticks = Ticks(1000.0, call, run.fail)

    async def shorten() -> None:
        asyncio.get_running_loop().call_soon(ticks.set_period, PERIOD)
        await run._run(ticks)

    asyncio.run(shorten())
    assert not run.errors
    assert len(run.times) >= 5
    later = run.times[1:]  # the second one was planned before the change
    assert len({(at + PERIOD / 100) // (2 * PERIOD) for at in later}) == len(later)
