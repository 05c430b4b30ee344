"""The loop whose timers are exact."""

from __future__ import annotations

import asyncio
import statistics
import time

import pytest

from link.runtime.event_loop import run_loop, running_loop

SHORT = 0.0002
"""s; asyncio's own loop makes a millisecond of it."""
FINE = 0.0009
"""s."""


async def one_in_time(tries: int) -> float:
    """s that a short sleep took: the first that was no later than FINE, else the last."""
    running, taken = asyncio.get_running_loop(), 0.0
    for _ in range(tries):
        start = running.time()
        await asyncio.sleep(SHORT)
        taken = running.time() - start
        if taken < FINE:
            break
    return taken


def test_a_timer_is_not_rounded_to_milliseconds() -> None:
    # a busy machine delays many, not all
    assert SHORT <= run_loop(one_in_time(5000)) < FINE


async def usual_time(tries: int) -> float:
    """s that a short sleep usually took. Where the process is preempted before the wait, the timer is due at once."""
    running, taken = asyncio.get_running_loop(), list[float]()
    for _ in range(tries):
        start = running.time()
        await asyncio.sleep(SHORT)
        taken.append(running.time() - start)
    return statistics.median(taken)


def test_asyncios_own_loop_would_fail_that() -> None:
    assert asyncio.run(usual_time(50)) >= FINE


def test_it_returns_what_main_returns_and_raises_what_it_raises() -> None:
    async def fails() -> None:
        raise ZeroDivisionError("a bug")

    assert run_loop(asyncio.sleep(0, "done")) == "done"
    with pytest.raises(ZeroDivisionError, match="a bug"):
        run_loop(fails())


def test_it_knows_how_long_it_has_waited_and_worked() -> None:
    async def work_and_wait() -> tuple[float, float]:
        loop = running_loop()
        before = loop.idle_time
        end = time.monotonic() + 0.05
        while time.monotonic() < end:
            continue
        worked = loop.idle_time - before
        await asyncio.sleep(0.05)
        return worked, loop.idle_time - before

    worked, waited = run_loop(work_and_wait())
    assert worked == 0.0
    assert waited > 0.0


async def test_another_loop_does_not_know() -> None:
    with pytest.raises(RuntimeError):
        running_loop()
