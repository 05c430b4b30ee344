"""What a verb sends last is sent, however often its caller is cancelled."""

from __future__ import annotations

import asyncio

import pytest

from groundstation.verbs.common.endings import wait_for_ends


def test_a_second_cancellation_does_not_leave_a_task_behind() -> None:
    said: list[str] = []

    async def verb() -> None:
        try:
            await asyncio.sleep(60)
        finally:
            await asyncio.sleep(0.02)
            said.append("neutral")

    async def call(task: asyncio.Task[None]) -> None:
        task.cancel()
        await wait_for_ends({task})

    async def script() -> None:
        task = asyncio.ensure_future(verb())
        await asyncio.sleep(0)
        caller = asyncio.ensure_future(call(task))
        for _ in range(3):
            await asyncio.sleep(0)
            caller.cancel()
        with pytest.raises(asyncio.CancelledError):
            await caller
        assert task.done()

    asyncio.run(script())
    assert said == ["neutral"]


def test_a_task_that_does_not_end_is_waited_for_no_longer() -> None:
    async def script() -> None:
        stubborn = asyncio.ensure_future(asyncio.sleep(60))
        await wait_for_ends({stubborn}, 0.01)
        assert not stubborn.done()
        stubborn.cancel()

    asyncio.run(script())
