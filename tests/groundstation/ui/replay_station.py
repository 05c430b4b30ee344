"""A replay behind the screen, in virtual time: a real desk with a small log, and no process."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path

from textual.pilot import Pilot

from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.intents.union import AnyIntent
from groundstation.replay.log_replay import LogReplay
from groundstation.ui.app.app import ConsoleApp
from groundstation.ui.keys.key_gate import STARTING
from groundstation.ui.look.appearance import Look
from tests.groundstation.replay.logs import finish
from tests.groundstation.ui import frames
from tests.groundstation.ui.examples import Recorder
from tests.groundstation.ui.settling import paint_changes, painted_when_seen
from tests.waits import until


class ReplayStation:
    """A replay behind `screen`. Time passes in `run` only."""

    def __init__(self, desk: LogReplay) -> None:
        self.desk = desk
        self.screen = Recorder(self._handle)
        self._now = 0.0

    def run(self, seconds: float) -> None:
        """Let real time pass, finish the work of the desk, and offer what it shows."""
        self._now += seconds
        finish(self.desk)
        self.desk.advance(self._now)
        self.desk.send_views(self.screen.offer_view, self._now)
        self.screen.offer(self.desk.snapshot())

    def _handle(self, *intents: AnyIntent) -> None:
        for intent in intents:
            self.desk.handle(intent)


@dataclass
class ReplayConsole:
    """A running app, its replay, and a hand."""

    app: ConsoleApp
    station: ReplayStation
    pilot: Pilot[int]

    async def show(self, seconds: float = 0.5, times: int = 4) -> None:
        """Let time pass in which the screen gets what it has requested."""
        for _ in range(times):
            before = self.app.drive.snapshot.number
            self.station.run(seconds)
            await until(lambda before=before: self.app.drive.snapshot.number > before)  # type: ignore[misc]
            await self.pilot.pause()

    async def press(self, *keys: str) -> None:
        """Press keys one after the other, and show what follows."""
        await self.pilot.press(*keys)
        await self.show(times=3)

    @property
    def text(self) -> str:
        """What the terminal shows."""
        return frames.text(self.app)


@contextlib.asynccontextmanager
async def replay_console(
    desk: LogReplay, size: tuple[int, int], *, first: str = "replay", look: Look | None = None, folder: Path = Path()
) -> AsyncIterator[ReplayConsole]:
    """The app at work with a replay on a screen."""
    station = ReplayStation(desk)
    keymap = Keymap("standard", KEYMAPS["standard"])
    app = ConsoleApp(station.screen, keymap, first=first, look=look or Look(reduce_motion=True), folder=folder)
    try:
        with painted_when_seen(app):
            async with app.run_test(size=size) as pilot:
                await until(lambda: app.gate.closure != STARTING)
                made = ReplayConsole(app, station, pilot)
                await made.show()
                yield made
                paint_changes(app.screen)
    finally:
        station.screen.close()
