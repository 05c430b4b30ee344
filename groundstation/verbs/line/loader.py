"""LineLoader: loads the verbs when the first line is typed, in a thread, because the station must not stand still."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING

from groundstation.intents.line import RunLine
from groundstation.station.station import Station
from groundstation.station.view_feed import ViewSource
from groundstation.views.line import RUNNING, LineRequest, LineView

if TYPE_CHECKING:
    from groundstation.verbs.line.line_commands import LineCommands

PERIOD = 0.1
"""s between two views."""


class LineLoader:
    """Takes the lines for `station`. `flush` sends what the station has queued."""

    def __init__(self, station: Station, flush: Callable[[], None]) -> None:
        self._station, self._flush = station, flush
        self._commands: LineCommands | None = None
        self._loading: asyncio.Task[None] | None = None
        self._waiting: list[RunLine] = []
        station.views.add(LineRequest, ViewSource(self._build, period=PERIOD))
        station.intents.add_last({RunLine: self._run})

    def _run(self, intent: RunLine, now: float) -> None:
        """Run a line, at once or when the verbs are loaded."""
        self._waiting.append(intent)
        self._run_waiting(now)

    def _build(self, request: LineRequest, now: float, wall: float) -> LineView:
        if self._commands is None:
            self._load()
            return LineView(request.number, RUNNING, "", request.text)
        return self._commands.build(request)

    def _run_waiting(self, now: float) -> None:
        if self._commands is None:
            self._load()
            return
        waiting, self._waiting = self._waiting, []
        for intent in waiting:
            self._commands.run(intent, now)

    def _load(self) -> None:
        if self._loading is None:
            self._loading = asyncio.get_running_loop().create_task(self._import())

    async def _import(self) -> None:
        module = await asyncio.to_thread(import_module, "groundstation.verbs.line.line_commands")
        self._commands = module.LineCommands(self._station, self._flush)
        self._run_waiting(asyncio.get_running_loop().time())
