"""The loop whose timers are exact."""

from __future__ import annotations

import asyncio

import pytest

from link.loop import run_loop

SHORT = 0.0002
"""s; asyncio's own loop makes a millisecond of it, each time."""


async def shortest_of(sleeps: int) -> float:
    """s that the best of so many short sleeps took: a busy machine delays some, not all."""
    running = asyncio.get_running_loop()
    taken = []
    for _ in range(sleeps):
        start = running.time()
        await asyncio.sleep(SHORT)
        taken.append(running.time() - start)
    return min(taken)


def test_a_timer_is_not_rounded_to_milliseconds() -> None:
    assert SHORT <= run_loop(shortest_of(200)) < 0.0009


def test_it_returns_what_main_returns_and_raises_what_it_raises() -> None:
    async def fails() -> None:
        raise ZeroDivisionError("a bug")

    assert run_loop(asyncio.sleep(0, "done")) == "done"
    with pytest.raises(ZeroDivisionError, match="a bug"):
        run_loop(fails())
