"""Pictures of the Drive screen with a copter: a stand-in that takes off and flies by keys."""

from __future__ import annotations

import math
import time

from dialects import messages as m
from dialects.messages import boot_ms
from groundstation.client import StationClient
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.intents.vehicle import Arm, TakeOff
from groundstation.intents.vehicle_intent import HOLD_TIME
from groundstation.ui.app.app import ConsoleApp
from tests.fakes.flying import FlyingVehicle
from tests.fakes.lines import on_line
from tests.fakes.multicopters import ArduCopter
from tests.groundstation.ui import frames
from tests.groundstation.ui.screenshots_drive import _hold, _until

HEIGHT = 6.0
CIRCLE = 8
"""Legs, each a while ahead and a turn."""
ANSWERED = 3.0
"""s after which a request is made again."""
VOLTAGE, CURRENT = 15900, 1850
"""mV and cA."""
HEALTHY = 0x1 | 0x2 | 0x4 | 0x8 | 0x20 | 0x8000 | 0x200000
"""Gyro, accelerometer, compass, pressure, GPS, motors, estimate."""


async def flight(size: tuple[int, int]) -> dict[str, frames.Picture]:
    """Return the Drive screen in the air, and on the ground before the take-off."""
    made = {}
    copter = ArduCopter(FENCE_ENABLE=1, FENCE_ALT_MAX=50)
    with on_line(copter, "udpin"):
        client = StationClient.start([copter.endpoint], speed=0.6, take_off=HEIGHT)
        try:
            app = ConsoleApp(client, Keymap("standard", KEYMAPS["standard"]))
            async with app.run_test(size=size) as pilot:
                await _until(pilot, lambda: app.drive.snapshot.vehicle is not None)
                await _until(pilot, lambda: _is_read(app))
                while not _is_armed(app):
                    client.send(Arm(held=HOLD_TIME))
                    await pilot.pause(ANSWERED)
                _tell(copter, 93)
                await pilot.pause(1.5)
                made["take_off"] = frames.cells(app)
                while not copter.flies:  # it disarms itself on the ground after a while
                    client.send(TakeOff(held=HOLD_TIME) if _is_armed(app) else Arm(held=HOLD_TIME))
                    await pilot.pause(ANSWERED)
                await _until(pilot, lambda: copter.altitude > HEIGHT - 0.1)
                for leg in range(CIRCLE):
                    _tell(copter, 93 - leg)
                    await _hold(pilot, "i", 2.0)
                    await _hold(pilot, "l", 0.8)
                await _hold(pilot, "w", 1.5)
                await _hold(pilot, "i", 1.5)
                made["flight"] = frames.cells(app)
        finally:
            client.close()
    return made


def _is_read(app: ConsoleApp) -> bool:
    """Return whether its settings are read, without which nothing is armed."""
    vehicle = app.drive.snapshot.vehicle
    return vehicle is not None and vehicle.altitude_fence is not None and bool(vehicle.link_loss_action)


def _is_armed(app: ConsoleApp) -> bool:
    vehicle = app.drive.snapshot.vehicle
    return vehicle is not None and vehicle.armed


def _tell(copter: FlyingVehicle, percent: int) -> None:
    """Let it report what its motion does not need: home, GPS, battery, attitude, health."""
    copter.send(m.HomePosition(470000000, 80000000, 400000, 0, 0, 0, [1.0, 0.0, 0.0, 0.0], 0, 0, 0))
    copter.send(m.GpsRawInt(0, 3, 470000000, 80000000, 400000, 80, 120, 0, 0, 14))
    copter.send(m.SysStatus(HEALTHY, HEALTHY, HEALTHY, 300, VOLTAGE, CURRENT, percent, 0, 0, 0, 0, 0, 0))
    copter.send(m.EkfStatusReport(0x33F, 0.1, 0.1, 0.1, 0.1, 0.0))
    copter.send(m.Attitude(boot_ms(time.monotonic()), math.radians(4), math.radians(-7), copter.heading, 0.0, 0.0, 0.0))
