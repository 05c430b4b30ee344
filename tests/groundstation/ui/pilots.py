"""The app without a terminal, as Textual's Pilot drives it: for what widgets show and what keys do on the screen."""

from __future__ import annotations

import contextlib
import time
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import pytest
from textual.pilot import Pilot

from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.snapshot import Snapshot
from groundstation.ui.app.app import MIN_FRAME_TIME, ConsoleApp
from groundstation.ui.app.help import HelpScreen
from groundstation.ui.app.without_looking import Aids
from groundstation.ui.base.screen import ConsoleScreen
from groundstation.ui.keys.key_gate import STARTING
from groundstation.ui.learn.lesson_dock import LessonDock
from groundstation.ui.look.appearance import PLAIN, Look
from groundstation.ui.terminal.key_parser import KeyEventParser
from tests.groundstation.held_key import HeldTime
from tests.groundstation.ui import frames
from tests.groundstation.ui.examples import Recorder, snapshot
from tests.groundstation.ui.settling import paint_changes, painted_when_seen
from tests.waits import until


@dataclass
class Console:
    """A running app, its station, and a hand."""

    app: ConsoleApp
    station: Recorder
    pilot: Pilot[int]
    clock: HeldTime
    offered: int = 0

    async def show(self, picture: Snapshot) -> None:
        """Let the station offer a picture and wait until it, and what follows from it, is on the screen."""
        self.offered += 1
        self.clock.skip(MIN_FRAME_TIME)  # else the app shows it with its next tick only
        self.station.offer(msgspec.structs.replace(picture, number=self.offered))
        await until(lambda: self.app.drive.snapshot.number == self.offered)
        await self.tick()

    async def tick(self) -> None:
        """Let a tick of the app pass, which closes the gate, requests views and draws: it comes within 0.1 s else."""
        self.clock.skip(MIN_FRAME_TIME)
        self.app._tick()
        await self.pilot.pause()

    async def press(self, *keys: str) -> None:
        """Press keys one after the other."""
        self.clock.skip(MIN_FRAME_TIME)
        await self.pilot.press(*keys)
        await self.tick()

    async def go_home(self) -> None:
        """Close all screens on top of Drive."""
        while self.app.screen is not self.app.drive:
            await self.press("escape")

    async def begin_anew(self, size: tuple[int, int], picture: Snapshot) -> None:
        """Be as an app that has just begun: Drive alone, nothing kept of other screens. Costs a third of a new one."""
        while self.app.screen is not self.app.drive:
            if isinstance(self.app.screen, ConsoleScreen):
                self.app._navigator.go_back()
                await self.pilot.pause()
            else:
                await self.press("escape")
        self.app._kept.clear()
        if tuple(self.app.size) != size:
            await self.pilot.resize_terminal(*size)
        for uptime in (picture.uptime + 60.0, picture.uptime):  # panes of Drive wait for another second
            await self.show(msgspec.structs.replace(picture, uptime=uptime))

    def is_clean(self, kind: type[ConsoleScreen]) -> bool:
        """Return whether a screen of this class is on top and has no text field and no question."""
        top = self.app.screen
        return isinstance(top, kind) and not top.takes_text and top.question is None

    async def hold(self, key: str, wanted: Callable[[], object]) -> None:
        """Hold a key long enough to confirm an action, by the clock of the app, and wait until it is true."""
        await self.clock.hold(lambda: self.press(key), ended=wanted)
        await until(wanted)

    @property
    def text(self) -> str:
        """What the terminal shows."""
        return frames.text(self.app)


@contextlib.asynccontextmanager
async def console(
    size: tuple[int, int] = (80, 24),
    picture: Snapshot | None = None,
    keymap: str = "standard",
    folder: Path = Path(),
    *,
    look: Look = PLAIN,
    clock: Callable[[], float] = time.monotonic,
    lesson: LessonDock | None = None,
    aids: Aids = Aids(),  # noqa: B008  # frozen
) -> AsyncIterator[Console]:
    """The app at work: a picture is shown and, where the size allows, keys drive."""
    station, held_time = Recorder(), HeldTime(clock)
    keys = Keymap(keymap, KEYMAPS[keymap])
    app = ConsoleApp(station, keys, folder=folder, look=look, clock=held_time, lesson=lesson, aids=aids)
    try:
        with painted_when_seen(app):
            async with app.run_test(size=size) as pilot:
                app._tick()  # else the first one comes within 0.1 s
                await until(lambda: app.gate.closure != STARTING)
                made = Console(app, station, pilot, held_time)
                await made.show(snapshot() if picture is None else picture)
                yield made
                paint_changes(app.screen)
    finally:
        station.close()


def type_in(screen: Console, data: str) -> None:
    """One read of the terminal: its keys are with the station when this returns, and the loop has had no turn yet."""
    for event in KeyEventParser(screen.app.gate).feed(data):
        event.set_sender(screen.app)
        screen.app.post_message(event)


def helps(screen: Console) -> int:
    return sum(isinstance(each, HelpScreen) for each in screen.app.screen_stack)


def helps_pushed(screen: Console, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Grows with each screen that is opened from now on: how many help screens there are then."""
    depths: list[int] = []
    push = screen.app.push_screen

    def noted(*arguments: Any, **options: Any) -> Any:
        pushed = push(*arguments, **options)
        depths.append(helps(screen))
        return pushed

    monkeypatch.setattr(screen.app, "push_screen", noted)
    return depths
