"""Pictures of the Connect screen for the documents: two real simulators are heard, nothing is sent to them.

python -m tests.groundstation.ui.screenshots_connect docs    writes docs/connect_80x24.svg ..., see screenshots.py.
The ports 14550 and 14551 of this machine must be free.
"""

from __future__ import annotations

import asyncio
import time

from groundstation.client import StationClient
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.processes import start_module
from groundstation.ui.app import ConsoleApp
from groundstation.ui.screens.connect import ConnectScreen
from tests.groundstation.ui import frames
from tests.groundstation.ui.example_connect import remember
from tests.groundstation.ui.screenshots import write_pictures

SIMULATORS = (["--sim", "udpout:127.0.0.1:14550"], ["--sim", "udpout:127.0.0.1:14551", "--system", "3"])


async def pictures(size: tuple[int, int]) -> dict[str, str]:
    """Name -> SVG."""
    remember(time.time())
    vehicles = [start_module("vehicle", options) for options in SIMULATORS]
    client = StationClient.start([])
    try:
        app = ConsoleApp(client, Keymap("standard", KEYMAPS["standard"]), first="connect")
        async with app.run_test(size=size) as pilot:
            async with asyncio.timeout(20.0):
                while not isinstance(app.screen, ConnectScreen) or "Rover 3" not in frames.text(app):
                    await pilot.pause(0.1)
            await pilot.pause(2.0)
            return {"connect": frames.svg(app)}
    finally:
        client.close()
        for vehicle in vehicles:
            vehicle.kill()
            vehicle.wait()


if __name__ == "__main__":
    write_pictures(pictures)
