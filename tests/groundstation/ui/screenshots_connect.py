"""Pictures of the Connect, Files and Links screens: real simulators, and a vehicle with files and logs."""

from __future__ import annotations

import asyncio
import os
import random
import tempfile
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

from textual.pilot import Pilot

from groundstation.client import StationClient
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.ui.app.app import ConsoleApp
from link.runtime.child_process import start_module
from tests.fakes.services import foreign_vehicle
from tests.groundstation.ui import frames
from tests.groundstation.ui.example_connect import remember
from tests.groundstation.ui.files.test_log_summary import HEARTBEATS, log

HEARD = (["--sim", "udpout:127.0.0.1:14550"], ["--sim", "udpout:127.0.0.1:14551", "--system", "3"])
FLEET = (
    ["--sim", "udpout:127.0.0.1:14550", "--home", "-35.3630,149.1652"],
    ["--sim", "udpout:127.0.0.1:14550", "--system", "2", "--home", "-35.3628,149.1656", "--sim-battery", "0.6"],
    ["--sim", "udpout:127.0.0.1:14551", "--system", "3", "--home", "-35.3632,149.1649", "--sim-battery", "0.3"],
)
SCRIPT = b"-- switches the lights by RC 7\n" * 70
KEYS = Keymap("standard", KEYMAPS["standard"])


async def _until(pilot: Pilot[int], app: ConsoleApp, wanted: Callable[[str], bool]) -> None:
    async with asyncio.timeout(30.0):
        while not wanted(frames.text(app)):
            await pilot.pause(0.1)


def write_logs(folder: Path) -> None:
    """Put telemetry logs into a folder, and a script that the vehicle has, too."""
    for number, (name, minutes, repeats) in enumerate(
        (("2026-11-22-1108-rover1.tlog", 41.0, 60_000), ("2026-11-21-1544-rover2.tlog", 12.5, 20_000),
         ("2026-11-19-0931-sitl.tlog", 6.2, 9_000), ("field-mavproxy.tlog", 80.1, 90_000))
    ):  # fmt: skip
        (folder / name).write_bytes(log(HEARTBEATS[:1] if number % 2 else HEARTBEATS[2:3], minutes * 60, repeats))
        os.utime(folder / name, (time.time() - number * 86_400 - 3600,) * 2)
    (folder / "lights.lua").write_bytes(SCRIPT)


@asynccontextmanager
async def rovers(*options: list[str]) -> AsyncIterator[None]:
    """Run simulated rovers."""
    running = [start_module("vehicle", each) for each in options]
    try:
        yield
    finally:
        for vehicle in running:
            vehicle.kill()
            vehicle.wait()


@asynccontextmanager
async def program(
    size: tuple[int, int], endpoints: list[str], folder: str, first: str = "drive"
) -> AsyncIterator[tuple[ConsoleApp, Pilot[int]]]:
    """Run the app with a station."""
    client = StationClient.start(endpoints)
    try:
        app = ConsoleApp(client, KEYS, first=first, folder=Path(folder))
        async with app.run_test(size=size) as pilot:
            yield app, pilot
    finally:
        client.close()


async def connect(size: tuple[int, int]) -> dict[str, frames.Picture]:
    """Return the Connect screen: two simulators are heard, and nothing was sent to them."""
    remember(time.time())
    with tempfile.TemporaryDirectory() as folder:
        write_logs(Path(folder))
        async with rovers(*HEARD), program(size, [], folder, first="connect") as (app, pilot):
            last = "1:20:06" if size[0] >= 140 else ""  # length of the last log; a narrow screen lists none
            await _until(pilot, app, lambda text: "Rover 3" in text and last in text)
            await pilot.pause(2.0)
            return {"connect": frames.cells(app)}


async def links(size: tuple[int, int]) -> dict[str, frames.Picture]:
    """Return the Links screen: three rovers on two links, a serial port that is not there."""
    endpoints = ["udpin:127.0.0.1:14550", "udpin:127.0.0.1:14551", "serial:/dev/ttyUSB0:57600"]
    with tempfile.TemporaryDirectory() as folder:
        async with rovers(*FLEET), program(size, endpoints, folder) as (app, pilot):
            await _until(pilot, app, lambda text: "Rover 1" in text)
            await pilot.press("f7")
            await _until(pilot, app, lambda text: all(f"Rover {number}" in text for number in (1, 2, 3)))
            await pilot.press("1", "enter")
            await _until(pilot, app, lambda text: text.count("°") >= 2)
            await pilot.pause(8.0)
            return {"links": frames.cells(app)}


async def files(size: tuple[int, int]) -> dict[str, frames.Picture]:
    """Return the Files screen: one log is here, one is on its way, a script was compared."""
    data = random.Random(1).randbytes(14_200_000)
    with foreign_vehicle() as vehicle, tempfile.TemporaryDirectory() as folder:
        write_logs(Path(folder))
        assert vehicle.files is not None
        vehicle.logs[:] = [data[:900_000], data[:190_000], data[:8_100_000], data]
        vehicle.files.files = {"/crash_dump.bin": data[:98_000], "/fence.txt": b"# none", "/lights.lua": SCRIPT}
        async with program(size, [vehicle.endpoint], folder) as (app, pilot):
            await _until(pilot, app, lambda text: "rover 1" in text)
            await pilot.press("ctrl+g", "9")
            await _until(pilot, app, lambda text: "190.0 kB" in text)
            await pilot.press("tab", "end", "C")
            await _until(pilot, app, lambda text: "accepted" in text)
            await pilot.press("shift+tab", "down", "down", "D")
            await _until(pilot, app, lambda text: "✓ 1-0" in text)
            await pilot.press("up", "up", "D")
            await _until(pilot, app, lambda text: "kB/s" in text or "MB/s" in text)
            await pilot.pause(1.0)
            return {"files": frames.cells(app)}
