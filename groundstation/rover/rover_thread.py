"""RoverThread: the thread with the event loop of a Rover, and how other threads call in it."""

from __future__ import annotations

import asyncio
import math
import threading
import time
from collections.abc import Callable, Coroutine
from concurrent.futures import wait
from typing import Any, TypeVar

from groundstation.rover.api_process import ApiProcess
from groundstation.rover.async_rover import AsyncRover
from groundstation.rover.connection import END_WITHIN
from groundstation.rover.protocol import WAITING_PERIOD

CLOSES_WITHIN = 0.02
"""s for the pipes of a process that has ended to be closed by the loop, which then closes, too."""
Result = TypeVar("Result")


class _Waiting:
    """When the thread that has called waited last. A Rover that is forgotten must not be held by its connection."""

    def __init__(self) -> None:
        self._at = -math.inf

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
        self._waiting = _Waiting()
        self.rover.waits = self._waiting.lately
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=_run, args=(self._loop,), name="mavhelm-rover", daemon=True)
        self._thread.start()

    def call(self, start: Callable[[AsyncRover], Coroutine[Any, Any, Result]]) -> Result:
        """Run a coroutine, and wait for it here; an exception here, as of Ctrl-C, cancels it."""
        self._waiting.note()
        future = asyncio.run_coroutine_threadsafe(start(self.rover), self._loop)
        try:
            while not future.done():
                wait((future,), WAITING_PERIOD)
                self._waiting.note()
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
