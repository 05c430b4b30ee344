"""Ticks: a function that is called regularly, at less cost than by Textual's timers."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from link.runtime.multiples import next_multiple


class Ticks:
    """Calls a function at the multiples of `period`, s: the station wakes at the same times, by the same clock.

    Textual 8.2.8 wakes a task and builds a coroutine for each call of a timer.
    """

    def __init__(self, period: float, call: Callable[[], object], fail: Callable[[Exception], object]) -> None:
        """`fail` takes an exception of `call`, which is not called again."""
        self.period, self._call, self._fail = period, call, fail
        self._timer: asyncio.TimerHandle | None = None

    def start(self, loop: asyncio.AbstractEventLoop) -> None:
        """Begin."""
        self._timer = loop.call_at(next_multiple(self.period, loop.time()), self._run, loop)

    def set_period(self, period: float) -> None:
        """Change the period. A shorter one counts at once, a longer one from the next tick on."""
        shorter, self.period = period < self.period, period
        if shorter and self._timer is not None and not self._timer.cancelled():
            self._timer.cancel()
            self.start(asyncio.get_running_loop())

    def stop(self) -> None:
        """End; does nothing before the start."""
        if self._timer is not None:
            self._timer.cancel()

    def _run(self, loop: asyncio.AbstractEventLoop) -> None:
        self.start(loop)  # first, because the call may stop the ticks
        try:
            self._call()
        except Exception as error:
            self.stop()
            self._fail(error)
