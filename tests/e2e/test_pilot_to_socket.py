"""Keys on the screen, by Textual's Pilot, to MANUAL_CONTROL on a real socket, through the real station process."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest

from groundstation import client as client_module
from groundstation.client import StationClient
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.intents.driving import SetStyle
from groundstation.ui.app.app import ConsoleApp
from tests.fakes.lines import on_line
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.held_key import HeldTime
from tests.groundstation.host.crashing_station import ORDER
from tests.groundstation.ui.frames import text
from tests.ports import free_port
from tests.waits import Patience, until

pytestmark = pytest.mark.e2e


async def soon(condition: Callable[[], bool]) -> None:
    """Wait a few seconds for an answer that may not come."""
    with suppress(TimeoutError):
        await until(condition, 5.0)


async def test_a_held_key_reaches_the_vehicle_and_the_stop_key_ends_it(tmp_path: Path) -> None:
    endpoint = f"udpin:127.0.0.1:{free_port()}"
    client = StationClient.start([endpoint], log_file=tmp_path / "log")
    clock = HeldTime(time.monotonic)
    app = ConsoleApp(client, Keymap("standard", KEYMAPS["standard"]), clock=clock)
    try:
        with on_line(FakeVehicle(), endpoint=endpoint) as vehicle:
            async with app.run_test(size=(80, 24)) as pilot:
                await until(lambda: app.drive.snapshot.vehicle is not None)
                patience = Patience()
                while not app.drive.snapshot.operator.gate_open:
                    # Again: a screen whose station has been late for a moment counts no hold that began then.
                    assert not patience.ended
                    await clock.hold(lambda: pilot.press("r"), ended=lambda: vehicle.armed)
                    await soon(lambda: app.drive.snapshot.operator.gate_open)
                pressed = time.monotonic()

                def driven() -> bool:
                    return any(x == 600 for _, x in vehicle.demands(pressed))

                patience = Patience()
                while not driven():  # again: a station that was delayed by 0.3 s has released the key
                    assert not patience.ended
                    await clock.hold(lambda: pilot.press("i"), ended=driven)
                await pilot.press("space")
                await until(lambda: vehicle.demands(pressed)[-1][1] == 0)
                stopped = time.monotonic()
                await until(lambda: len(vehicle.demands(stopped)) > 3)
                assert {x for _, x in vehicle.demands(stopped)} == {0}
    finally:
        client.close()


async def test_a_bug_in_the_station_is_told_on_the_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client_module, "STATION", "tests.groundstation.host.crashing_station")
    station = StationClient.start([f"udpin:127.0.0.1:{free_port()}"])
    app = ConsoleApp(station, Keymap("standard", KEYMAPS["standard"]))
    try:
        async with app.run_test(size=(80, 24)) as pilot:
            await until(lambda: app.drive.snapshot.number > 0)
            station.send(SetStyle(style=ORDER + "tick"))
            await until(lambda: not station.alive)
            await until(lambda: "station crashed (ZeroDivisionError" in text(app))
            await pilot.pause()
    finally:
        assert station.close() == 1
