"""Imports what a verb needs beside what else the verb does. It loads asyncio, which the tables of verbs do without."""

from __future__ import annotations

import asyncio
from typing import Any

from groundstation.verbs.common.lazy import LazyAttribute, LazyCall


async def load(function: Any) -> None:
    """Import what a stand-in stands for in a thread, so that the loop goes on. Does nothing for anything else."""
    if isinstance(function, LazyAttribute | LazyCall):
        await asyncio.to_thread(function.resolve)
