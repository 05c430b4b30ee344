"""RoverThread: the thread with the event loop of a Rover, and how other threads call in it."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable, Coroutine
from concurrent.futures import wait
from contextvars import copy_context
from typing import Any, TypeVar

from groundstation.rover.api_process import ApiProcess
from groundstation.rover.async_rover import AsyncRover
from groundstation.rover.connection import END_WITHIN, WAITS
from groundstation.rover.protocol import WAITING_PERIOD

CLOSES_WITHIN = 0.02
"""s for the pipes of a process that has ended to be closed by the loop, which then closes, too."""
Result = TypeVar("Result")


class _Waiting:
    """When the thread that has made a call waited for it last."""

    def __init__(self) -> None:
        self._at = time.monotonic()

    def note(self) -> None:
        """Note that it waits."""
        self._at = time.monotonic()

    def lately(self) -> bool:
        """Return whether it waits."""
        return time.monotonic() - self._at < 2 * WAITING_PERIOD


class RoverThread:
    """One thread, from the start on, and an AsyncRover in it."""

    def __init__(self, process: ApiProcess) -> None:
        self.rover = AsyncRover.of(process)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=_run, args=(self._loop,), name="mavhelm-rover", daemon=True)
        self._thread.start()

    def call(self, start: Callable[[AsyncRover], Coroutine[Any, Any, Result]]) -> Result:
        """Run a coroutine, and wait for it here; an exception here, as of Ctrl-C, cancels it."""
        waiting, context = _Waiting(), copy_context()
        context.run(WAITS.set, waiting.lately)  # of this call: another thread that waits must not keep it driving
        future = context.run(asyncio.run_coroutine_threadsafe, start(self.rover), self._loop)
        try:
            while not future.done():
                wait((future,), WAITING_PERIOD)
                waiting.note()
            return future.result()
        except BaseException:
            if future.cancel():  # neutral is sent before the exception goes on
                asyncio.run_coroutine_threadsafe(self.rover.settle(), self._loop).result()
            raise

    def close(self) -> None:
        """Disconnect, and end the thread."""
        try:
            self.call(lambda rover: rover.close())
        finally:
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join(END_WITHIN)


def _run(loop: asyncio.AbstractEventLoop) -> None:
    """Run the loop, as its thread."""
    asyncio.set_event_loop(loop)
    try:
        loop.run_forever()
        loop.run_until_complete(asyncio.sleep(CLOSES_WITHIN))
    finally:
        loop.close()
