"""An event loop in virtual time."""

from __future__ import annotations

import asyncio
import selectors
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, TypeVar

Result = TypeVar("Result")


class Inline(ThreadPoolExecutor):
    """Does work at once, in place of threads, whose time is not that of the loop: a test does the same each time."""

    def submit(self, fn: Callable[..., Result], /, *args: Any, **kwargs: Any) -> Future[Result]:
        done: Future[Result] = Future()
        try:
            done.set_result(fn(*args, **kwargs))
        except BaseException as error:
            done.set_exception(error)
        return done


class _WorldSelector(selectors.DefaultSelector):
    def __init__(self, advance: Callable[[], None]) -> None:
        super().__init__()
        self._advance = advance

    def select(self, timeout: float | None = None) -> Any:
        if timeout is None or timeout > 0:
            self._advance()
        return super().select(0)


class WorldLoop(asyncio.SelectorEventLoop):
    """An event loop whose clock is that of a test: where it would wait, `advance` lets a step of time pass."""

    def __init__(self, clock: Callable[[], float], advance: Callable[[], None]) -> None:
        super().__init__(_WorldSelector(advance))
        self._world_clock = clock
        self.set_default_executor(Inline())

    def time(self) -> float:
        return self._world_clock()
