"""Waits for tasks that end: what a verb sends last must not be lost because its caller is cancelled once more."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Collection
from typing import Any


async def wait_for_ends(tasks: Collection[asyncio.Future[Any]], within: float = math.inf) -> None:
    """Wait until tasks that were cancelled have ended, `within` s at most, also while this task is cancelled.

    A task for which nobody waits may be destroyed before its end. Raises CancelledError only behind the wait.
    """
    loop = asyncio.get_running_loop()
    until, cancelled = loop.time() + within, False
    while (left := {each for each in tasks if not each.done()}) and loop.time() < until:
        try:
            await asyncio.wait(left, timeout=None if until == math.inf else until - loop.time())
        except asyncio.CancelledError:
            cancelled = True
    if cancelled:
        raise asyncio.CancelledError
