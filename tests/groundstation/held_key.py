"""A held key as a terminal sends it: the press, a pause, then repeats. Every test that arms with keys uses it."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Iterator

DELAY = 0.4
"""s from the press to the first repeat."""

GAP = 0.033
"""s between repeats: 30 a second, as most systems send."""


def event_times(seconds: float, delay: float = DELAY, gap: float = GAP) -> Iterator[float]:
    """Yield the times of the press and of all repeats of a key that is held for so long."""
    yield 0.0
    at = delay
    while at <= seconds:
        yield at
        at += gap


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
