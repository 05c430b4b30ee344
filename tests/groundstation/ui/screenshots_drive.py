"""Pictures of the screens that show a drive of the simulated rover, of its parameters, and of a mission."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from textual.pilot import Pilot

from groundstation.client import StationClient
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.ui.app.app import ConsoleApp
from tests.groundstation.held_key import hold_until
from tests.groundstation.ui import frames
from tests.groundstation.ui.map_pictures import map_picture

DRIVE: tuple[tuple[str, float], ...] = (
    ("i", 5.0), ("o", 1.1), ("i", 4.0), ("u", 1.6), ("i", 4.0), ("o", 0.9), ("i", 3.0), ("u", 2.4), ("i", 3.0),
    ("o", 0.7),
)  # fmt: skip
"""Keys and how long each is held, s."""

GAP = 0.05
"""s between two repeats of a held key."""


@asynccontextmanager
async def armed_app(size: tuple[int, int]) -> AsyncIterator[tuple[ConsoleApp, Pilot[int]]]:
    """The app with a simulated rover that is armed."""
    client = StationClient.start([], sitl=True, speed=0.8)
    try:
        app = ConsoleApp(client, Keymap("standard", KEYMAPS["standard"]))
        async with app.run_test(size=size) as pilot:
            await _until(pilot, lambda: app.drive.snapshot.vehicle is not None)
            await hold_until(
                lambda: pilot.press("r"),
                lambda: app.drive.snapshot.vehicle is not None and app.drive.snapshot.vehicle.armed,
            )
            yield app, pilot
    finally:
        client.close()


async def _until(pilot: Pilot[int], wanted: Callable[[], bool]) -> None:
    async with asyncio.timeout(90.0):
        while not wanted():
            await pilot.pause(GAP)


async def _hold(pilot: Pilot[int], key: str, seconds: float) -> None:
    loop = asyncio.get_running_loop()
    end = loop.time() + seconds
    while loop.time() < end:
        await pilot.press(key)
        await pilot.pause(GAP)


async def mission(size: tuple[int, int]) -> dict[str, frames.Picture]:
    """Return the Map screen while AUTO drives."""
    async with armed_app(size) as (app, pilot):
        return {"map": await map_picture(app, pilot, partial(_until, pilot))}


async def drive(size: tuple[int, int]) -> dict[str, frames.Picture]:
    """Return the screens that show a drive, while it goes on and after it."""
    async with armed_app(size) as (app, pilot):
        await pilot.press("f5")
        await pilot.pause(1.0)
        await pilot.press("f1")
        await pilot.pause(1.0)
        for key, seconds in DRIVE:
            await _hold(pilot, key, seconds)
        made = {"drive": frames.cells(app)}
        await pilot.press("f3")
        await pilot.pause(1.5)
        while "SYS_STATUS #1" not in frames.text(app):
            await pilot.press("down")
            await pilot.pause(0.5)
        await pilot.press("tab", "down")
        await pilot.pause(12.0)
        made["messages"] = frames.cells(app)
        await pilot.press("f5")
        await pilot.pause(0.5)
        await pilot.press("1", "z", "shift+left")
        await pilot.pause(0.5)
        made["charts"] = frames.cells(app)
        return made | await _stopped(app, pilot)


async def _stopped(app: ConsoleApp, pilot: Pilot[int]) -> dict[str, frames.Picture]:
    """Return what is shown of modes, an emergency stop and checks."""
    made = {}
    await pilot.press("f1")
    for key in ("2", "1", "i", "space", "exclamation_mark"):
        await pilot.press(key)
        await pilot.pause(1.0)
    await pilot.press("f8")
    await pilot.pause(1.0)
    await pilot.press("c")
    await pilot.pause(3.0)
    made["setup"] = frames.cells(app)
    await pilot.press("f6")
    await pilot.pause(1.0)
    made["log"] = frames.cells(app)
    return made


SAFE = "FS_TIMEOUT 1\nFS_GCS_TIMEOUT 3\nMOT_THR_MAX 60\nMOT_SLEWRATE 250\n"
"""A parameter file to compare with."""


async def _params(size: tuple[int, int], folder: Path) -> dict[str, frames.Picture]:
    """The Parameters screen with a file of this folder that is compared, and its values as changes."""
    client = StationClient.start([], sitl=True)
    try:
        app = ConsoleApp(client, Keymap("standard", KEYMAPS["standard"]), folder=folder)
        async with app.run_test(size=size) as pilot:
            await _until(pilot, lambda: app.drive.snapshot.vehicle is not None)
            await pilot.press("f4")
            await _until(pilot, lambda: "Turn rate" in frames.text(app))
            await pilot.press("O", *"safe", "full_stop", *"param", "enter")
            await pilot.pause(1.0)
            await pilot.press("a", "slash", *"fs", "underscore", "space", *"mot", "underscore", "enter")
            await pilot.pause(1.0)
            await pilot.press(*["down"] * 9)
            await _until(pilot, lambda: "edits wait" in frames.text(app))
            return {"params": frames.cells(app)}
    finally:
        client.close()


def write_safe(folder: Path) -> None:
    """Write the file to compare with."""
    (folder / "safe.param").write_text(SAFE)


async def params(size: tuple[int, int]) -> dict[str, frames.Picture]:
    """Return the Parameters screen with a file that is compared."""
    with TemporaryDirectory() as folder:
        write_safe(Path(folder))
        return await _params(size, Path(folder))
