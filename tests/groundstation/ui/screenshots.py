"""Pictures for the documents: the real app, station and simulator drive a while, and what is shown then is kept.

python -m tests.groundstation.ui.screenshots docs    writes docs/drive_80x24.svg, docs/log_80x24.svg ...,
and PNG files of them where rsvg-convert (Debian: librsvg2-bin, with fonts-jetbrains-mono) is installed.
"""

from __future__ import annotations

import argparse
import asyncio
import shutil
import subprocess
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from textual.pilot import Pilot

from groundstation.client import StationClient
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.ui.app import ConsoleApp
from tests.groundstation.held_key import hold_until
from tests.groundstation.ui import frames
from tests.groundstation.ui.map_pictures import map_picture

SIZES = ((80, 24), (140, 45), (200, 60))

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


async def pictures(size: tuple[int, int]) -> dict[str, str]:
    """Name -> SVG."""
    made = {}
    async with armed_app(size) as (app, pilot):
        made["map"] = await map_picture(app, pilot, partial(_until, pilot))
    async with armed_app(size) as (app, pilot):
        await pilot.press("f5")
        await pilot.pause(1.0)
        await pilot.press("v")
        for _ in range(6):
            await pilot.press("p", "down")
        await pilot.pause(1.0)
        await pilot.press("f1")
        await pilot.pause(1.0)
        for key, seconds in DRIVE:
            await _hold(pilot, key, seconds)
        made["drive"] = frames.svg(app)
        await pilot.press("f6")
        await pilot.pause(1.0)
        made["log"] = frames.svg(app)
        await pilot.press("f3")
        await pilot.pause(1.5)
        while "SYS_STATUS #1" not in frames.text(app):
            await pilot.press("down")
            await pilot.pause(0.5)
        await pilot.press("tab", "down")
        await pilot.pause(12.0)
        made["messages"] = frames.svg(app)
        await pilot.press("f5")
        await pilot.pause(0.5)
        await pilot.press("1", "z", "shift+left")
        await pilot.pause(0.5)
        made["charts"] = frames.svg(app)
        await pilot.press("f1")
        await pilot.press("exclamation_mark")
        await pilot.pause(1.0)
        made["emergency"] = frames.svg(app)
        await pilot.press("f8")
        await pilot.pause(1.0)
        await pilot.press("c")
        await pilot.pause(3.0)
        made["setup"] = frames.svg(app)
        await pilot.press("question_mark")
        await pilot.pause(0.5)
        made["help"] = frames.svg(app)
    return made


SAFE = "FS_TIMEOUT 1\nFS_GCS_TIMEOUT 3\nMOT_THR_MAX 60\nMOT_SLEWRATE 250\n"
"""A parameter file to compare with."""


async def param_pictures(size: tuple[int, int], folder: Path) -> dict[str, str]:
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
            return {"params": frames.svg(app)}
    finally:
        client.close()


async def all_pictures(size: tuple[int, int]) -> dict[str, str]:
    """Name -> SVG of all screens."""
    with TemporaryDirectory() as files:
        return await pictures(size) | await param_pictures(size, write_safe(Path(files)))


def write_safe(folder: Path) -> Path:
    """Write the file to compare with; return the folder."""
    (folder / "safe.param").write_text(SAFE)
    return folder


def write_pictures(make: Callable[[tuple[int, int]], Awaitable[dict[str, str]]]) -> None:
    """Write what `make` returns for each size into the folder of the command line."""
    parser = argparse.ArgumentParser(description="Make the pictures of the documents.")
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    for width, height in SIZES:
        for name, svg in asyncio.run(_await(make((width, height)))).items():
            file = folder / f"{name}_{width}x{height}.svg"
            file.write_text(svg, "utf-8")
            if converter := shutil.which("rsvg-convert"):
                subprocess.run([converter, "-o", file.with_suffix(".png"), file], check=True)
            print(file)


async def _await(made: Awaitable[dict[str, str]]) -> dict[str, str]:
    return await made


if __name__ == "__main__":
    write_pictures(all_pictures)
