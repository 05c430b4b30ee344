"""The loop whose timers are exact."""

from __future__ import annotations

import asyncio
import time

import pytest

from link.loop import run_loop, running_loop

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


def test_it_knows_how_long_it_has_waited_and_how_long_it_has_worked() -> None:
    async def work_and_wait() -> tuple[float, float]:
        loop = running_loop()
        before = loop.waited
        end = time.monotonic() + 0.05
        while time.monotonic() < end:
            continue
        worked = loop.waited - before
        await asyncio.sleep(0.05)
        return worked, loop.waited - before

    worked, waited = run_loop(work_and_wait())
    assert worked == 0.0
    assert waited > 0.0


async def test_another_loop_does_not_know() -> None:
    with pytest.raises(RuntimeError):
        running_loop()
