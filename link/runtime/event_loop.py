"""The event loop of both programs: asyncio's, with timers as exact as the kernel's.

asyncio waits in epoll, whose timeout is in whole ms, and rounds up: a control cycle comes up to 1 ms late, and a paced
serial line idles after a frame. select() takes us. It cannot watch descriptors above 1023, and costs more with many;
both programs have a few dozen (the bridge, which may have more and has no deadlines, keeps epoll).
"""

from __future__ import annotations

import asyncio
import selectors
import time
from collections.abc import Coroutine
from typing import Any, TypeVar

T = TypeVar("T")


class _TimedSelector(selectors.SelectSelector):
    """Measures how long it has waited."""

    def __init__(self) -> None:
        super().__init__()
        self.waited = 0.0

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        began = time.monotonic()
        try:
            return super().select(timeout)
        finally:
            self.waited += time.monotonic() - began


class TimedEventLoop(asyncio.SelectorEventLoop):
    """Measures its idle time."""

    def __init__(self) -> None:
        self._waits = _TimedSelector()
        super().__init__(self._waits)

    @property
    def idle_time(self) -> float:
        """Time without work so far, s."""
        return self._waits.waited


def running_loop() -> TimedEventLoop:
    """Return the running loop of `run_loop`. Raises RuntimeError in any other loop."""
    loop = asyncio.get_running_loop()
    if not isinstance(loop, TimedEventLoop):
        raise RuntimeError("this is not a loop of run_loop")
    return loop


def run_loop(main: Coroutine[Any, Any, T]) -> T:
    """Run `main` as asyncio.run does, on a TimedEventLoop."""
    with asyncio.Runner(loop_factory=TimedEventLoop) as runner:
        return runner.run(main)
