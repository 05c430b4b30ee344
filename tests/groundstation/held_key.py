"""A held key as a terminal sends it: the press, a pause, then repeats. Every test that arms with keys uses it."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager

from groundstation.intents.vehicle_intent import HOLD_TIME

DELAY = 0.4
"""s from the press to the first repeat."""

GAP = 0.033
"""s between repeats: 30 a second, as most systems send."""

DRAWN = 0.1
"""s after which an app draws anew: above its MIN_FRAME_TIME, below its WITHOUT_SNAPSHOT."""

HELD = HOLD_TIME + 1.0
"""s for which a key is held that confirms an action."""


def event_times(seconds: float, delay: float = DELAY, gap: float = GAP) -> Iterator[float]:
    """Yield the times of the press and of all repeats of a key that is held for so long."""
    yield 0.0
    at = delay
    while at <= seconds:
        yield at
        at += gap


class HeldTime:
    """A clock that goes on as another one does, but goes at the pace of a key while that is held by `hold`.

    A hold is measured between the events of the key. A test that presses it by calls would need a machine that is never
    late by REPEAT_GAP for all of HOLD_TIME.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._offset = 0.0
        self._stands_at: float | None = None

    def __call__(self) -> float:
        """Return the time, s."""
        return self._clock() + self._offset if self._stands_at is None else self._stands_at

    def skip(self, seconds: float) -> None:
        """Let so much time pass at once; none while it stands still."""
        self._offset += seconds

    async def hold(
        self, press: Callable[[], Awaitable[object]], seconds: float = HELD, ended: Callable[[], object] = lambda: False
    ) -> None:
        """Press a key as one that is held for so long, or until `ended`, which is asked after each event."""
        with self.stand():
            begun = self()
            for at in event_times(seconds):
                self._stands_at = begun + at
                await press()
                if ended():
                    return

    @contextmanager
    def stand(self) -> Iterator[None]:
        """Let the time stand still: what is shown for a second after a key stays until the screen is drawn."""
        self.skip(DRAWN)
        self._stands_at = self()
        try:
            yield
        finally:
            self._offset = self._stands_at - self._clock()
            self._stands_at = None


async def hold_until(press: Callable[[], Awaitable[None]], wanted: Callable[[], object], within: float = 60.0) -> None:
    """Hold a key until it is true; TimeoutError after so many s. A machine that is late only makes it last longer."""
    async with asyncio.timeout(within):
        await press()
        await _pause(DELAY)
        while not wanted():
            await press()
            await _pause(GAP)


async def _pause(seconds: float) -> None:
    loop = asyncio.get_running_loop()
    turn = loop.create_future()
    loop.call_later(seconds, turn.set_result, None)
    await turn
