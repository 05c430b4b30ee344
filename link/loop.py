"""The event loop of both programs: asyncio's, with timers as exact as the kernel's.

asyncio waits in epoll, whose timeout is whole milliseconds, and rounds up: a control cycle comes up to 1 ms late, and a
frame that is paced to a serial wire leaves a gap behind it. select() takes microseconds. It looks at no descriptor
above 1023, and costs more with many; both programs have a few dozen (the bridge, which may have more and has no
deadlines, stays with epoll).
"""

from __future__ import annotations

import asyncio
import selectors
from collections.abc import Coroutine
from typing import Any, TypeVar

T = TypeVar("T")


def run_loop(main: Coroutine[Any, Any, T]) -> T:
    """As asyncio.run."""
    with asyncio.Runner(loop_factory=_loop) as runner:
        return runner.run(main)


def _loop() -> asyncio.AbstractEventLoop:
    return asyncio.SelectorEventLoop(selectors.SelectSelector())
