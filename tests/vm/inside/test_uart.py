"""A serial link between two emulated 16550 UARTs, through the kernel's own driver, with the vehicle and the bridge."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.vehicle.ground import Ground
from tests.vm.inside.header import GPIO, ahead, drive, rover, silent, until, write_config
from tests.waits import PATIENCE

VEHICLE_END, BRIDGE_END = "serial:/dev/ttyS1:115200", "serial:/dev/ttyS2:115200"


def test_cable_drives_it_and_a_kill_of_the_other_end_stops_it(tmp_path: Path) -> None:
    with Ground() as ground, rover(write_config(tmp_path, VEHICLE_END, GPIO)):
        bridge = subprocess.Popen([sys.executable, "-m", "link.bridge", BRIDGE_END, ground.endpoint])
        try:
            drive(ground)
            ground.wait(ahead, "both motors run forward")
        finally:
            bridge.kill()
            bridge.wait(PATIENCE)
        until(silent, "all inputs are low")
