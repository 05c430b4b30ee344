"""The app without a terminal, as Textual's Pilot drives it: for what widgets show and what keys do on the screen."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass

import msgspec
from textual.pilot import Pilot

from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.snapshot import Snapshot
from groundstation.ui.app import ConsoleApp
from groundstation.ui.key_gate import STARTING
from tests.groundstation.held_key import hold_until
from tests.groundstation.ui import frames
from tests.groundstation.ui.examples import Recorder, snapshot
from tests.groundstation.ui.ptys import until


@dataclass
class Console:
    """A running app, its station, and a hand."""

    app: ConsoleApp
    station: Recorder
    pilot: Pilot[int]
    offered: int = 0

    async def show(self, picture: Snapshot) -> None:
        """Let the station offer a picture and wait until it is on the screen."""
        self.offered += 1
        self.station.offer(msgspec.structs.replace(picture, number=self.offered))
        await until(lambda: self.app.drive.snapshot.number == self.offered)
        await self.pilot.pause()

    async def press(self, *keys: str) -> None:
        """Press keys one after the other."""
        await self.pilot.press(*keys)
        await self.pilot.pause()

    async def hold(self, key: str, wanted: Callable[[], object]) -> None:
        """Hold a key until it is true."""
        await hold_until(lambda: self.press(key), wanted)

    @property
    def text(self) -> str:
        """What the terminal shows."""
        return frames.text(self.app)


@contextlib.asynccontextmanager
async def console(
    size: tuple[int, int] = (80, 24), picture: Snapshot | None = None, keymap: str = "standard"
) -> AsyncIterator[Console]:
    """The app at work: a picture is shown and, where the size allows, keys drive."""
    station = Recorder()
    app = ConsoleApp(station, Keymap(keymap, KEYMAPS[keymap]))
    try:
        async with app.run_test(size=size) as pilot:
            await until(lambda: app.gate.closure != STARTING)
            made = Console(app, station, pilot)
            await made.show(snapshot() if picture is None else picture)
            yield made
    finally:
        station.close()
