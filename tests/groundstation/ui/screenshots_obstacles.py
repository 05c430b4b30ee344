"""Pictures of a rover between walls, driven over two links of which one is late: Drive, Map and Links."""

from __future__ import annotations

import asyncio
import contextlib
import json
import math
import tempfile
from collections.abc import Callable
from pathlib import Path

from textual.pilot import Pilot

from tests.groundstation.held_key import hold_until
from tests.groundstation.ui import frames
from tests.groundstation.ui.screenshots_connect import program, rovers

HOME = (-35.3630, 149.1652)
METRE = 1 / 111_320
"""Degrees of latitude."""
WALLS: tuple[tuple[tuple[float, float], ...], ...] = (
    ((-2.0, -1.6), (5.5, -1.6), (5.5, 2.6), (-2.0, 2.6)),
    ((2.6, 1.2), (2.6, 2.2), (3.6, 2.2), (3.6, 1.2), (2.6, 1.2)),
)
"""Lines of points, m north and east of HOME."""
ENDPOINTS = ["udpin:127.0.0.1:14550", "udpin:127.0.0.1:14551"]
GAP = 0.05
LET_GO = 1.2
"""s without a repeat after which a key counts as released (1.1 s at most)."""


def write_walls(file: Path) -> None:
    """Write WALLS as GeoJSON."""
    east = METRE / math.cos(math.radians(HOME[0]))
    lines = [[[HOME[1] + y * east, HOME[0] + x * METRE] for x, y in line] for line in WALLS]
    file.write_text(json.dumps({"type": "MultiLineString", "coordinates": lines}))


async def _until(pilot: Pilot[int], wanted: Callable[[], bool]) -> None:
    async with asyncio.timeout(60.0):
        while not wanted():
            await pilot.pause(GAP)


async def _drive_until(pilot: Pilot[int], wanted: Callable[[], bool]) -> None:
    """Hold the drive key, and press it again where a late machine has let it go."""
    async with asyncio.timeout(120.0):
        while True:
            with contextlib.suppress(TimeoutError):
                await hold_until(lambda: pilot.press("i"), wanted, within=6.0)
                return
            await pilot.pause(LET_GO)


async def obstacles(size: tuple[int, int]) -> dict[str, frames.Picture]:
    """Return Drive while a wall limits the speed, Map with what the sensors see, and Links with both links."""
    with tempfile.TemporaryDirectory() as folder:
        walls = Path(folder) / "walls.geojson"
        write_walls(walls)
        vehicle = ["--sim", "--walls", str(walls), f"--home={HOME[0]},{HOME[1]}"]
        outs = [each.replace("udpin", "udpout") for each in ENDPOINTS]
        async with rovers([*vehicle, *outs]), program(size, ENDPOINTS, folder) as (app, pilot):
            await _until(pilot, lambda: app.drive.snapshot.vehicle is not None)
            await hold_until(
                lambda: pilot.press("r"),
                lambda: app.drive.snapshot.vehicle is not None and app.drive.snapshot.vehicle.armed,
            )
            await pilot.pause(1.5)
            await _drive_until(pilot, lambda: "≤0" in frames.text(app) and "obstacle" in frames.text(app))
            made = {"obstacles": frames.cells(app)}
            await pilot.press("f2")
            await pilot.pause(3.0)
            made["obstacles_map"] = frames.cells(app)
            await pilot.press("f7")
            await pilot.pause(3.0)
            await pilot.press("tab")
            await pilot.pause(1.0)
            made["obstacles_links"] = frames.cells(app)
            return made
