"""Pictures of the Connect and Files screens for the documents: real simulators, and a vehicle with files and logs.

python -m tests.groundstation.ui.screenshots_connect docs    writes docs/connect_80x24.svg ..., see screenshots.py.
The ports 14550 and 14551 of this machine must be free.
"""

from __future__ import annotations

import asyncio
import random
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from textual.pilot import Pilot

from groundstation.client import StationClient
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.processes import start_module
from groundstation.ui.app import ConsoleApp
from tests.groundstation.foreign_vehicle import ForeignVehicle
from tests.groundstation.ui import frames
from tests.groundstation.ui.example_connect import remember
from tests.groundstation.ui.screenshots import write_pictures

SIMULATORS = (["--sim", "udpout:127.0.0.1:14550"], ["--sim", "udpout:127.0.0.1:14551", "--system", "3"])
KEYS = Keymap("standard", KEYMAPS["standard"])


async def _until(pilot: Pilot[int], app: ConsoleApp, wanted: Callable[[str], bool]) -> None:
    async with asyncio.timeout(30.0):
        while not wanted(frames.text(app)):
            await pilot.pause(0.1)


async def connect(size: tuple[int, int]) -> str:
    """Two simulators are heard, and nothing was sent to them."""
    remember(time.time())
    vehicles = [start_module("vehicle", options) for options in SIMULATORS]
    client = StationClient.start([])
    try:
        app = ConsoleApp(client, KEYS, first="connect", folder=Path(tempfile.gettempdir()))
        async with app.run_test(size=size) as pilot:
            await _until(pilot, app, lambda text: "Rover 3" in text)
            await pilot.pause(2.0)
            return frames.svg(app)
    finally:
        client.close()
        for vehicle in vehicles:
            vehicle.kill()
            vehicle.wait()


async def files(size: tuple[int, int]) -> str:
    """One log is here, one is on its way."""
    data = random.Random(1).randbytes(14_200_000)
    with ForeignVehicle() as vehicle, tempfile.TemporaryDirectory() as folder:
        assert vehicle.files is not None
        vehicle.logs = [data[:900_000], data[:190_000], data[:8_100_000], data]
        vehicle.files.files = {"/crash_dump.bin": data[:98_000], "/lights.lua": data[:2100], "/fence.txt": b"# none"}
        client = StationClient.start([vehicle.endpoint])
        try:
            app = ConsoleApp(client, KEYS, folder=Path(folder))
            async with app.run_test(size=size) as pilot:
                await _until(pilot, app, lambda text: "rover 1" in text)
                await pilot.press("ctrl+g")
                await pilot.press("9")
                await _until(pilot, app, lambda text: "190.0 kB" in text)
                for key in ("down", "down", "D"):
                    await pilot.press(key)
                await _until(pilot, app, lambda text: "✓ 1-0" in text)
                for key in ("up", "up", "D"):
                    await pilot.press(key)
                await _until(pilot, app, lambda text: "kB/s" in text or "MB/s" in text)
                await pilot.pause(1.0)
                return frames.svg(app)
        finally:
            client.close()


async def pictures(size: tuple[int, int]) -> dict[str, str]:
    """Name -> SVG."""
    return {"connect": await connect(size), "files": await files(size)}


if __name__ == "__main__":
    write_pictures(pictures)
