"""Signed driving with the real programs: keys in files, a station that is killed, and a watchdog that signs for it."""

from __future__ import annotations

import os
import signal
from contextlib import ExitStack
from pathlib import Path

import pytest

from link.signing.key_actions import make_key
from link.signing.key_file import FILE, load_keys, save_keys, station_key_file
from link.signing.role import SigningRole
from tests.e2e.conftest import Rig
from tests.e2e.programs import GroundStation, Vehicle
from tests.e2e.relay import Relay
from tests.e2e.test_station_process_lost import station_of
from tests.groundstation.screen import children
from tests.waits import PATIENCE, Waits

pytestmark = pytest.mark.e2e

LOST = "manual control lost"
BUSY = 0.1
"""s for which the machine made the vehicle or the watchdog wait: then the failsafe may come first."""


def test_key_given_to_running_station_drives_and_signs_its_stops(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The vehicle ignores what is not signed. The key comes while station and watchdog run.

    Neutral goes on for 5 s, so that the vehicle's own failsafe, which would stop it as well, has nothing to do.
    """
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    make_key(tmp_path / FILE, "laptop", SigningRole.SET_UP)
    file = tmp_path / "rover.toml"
    file.write_text("[signing]\nrequired = true\n")
    with ExitStack() as stack:
        relay = Relay()
        stack.callback(relay.close)
        station = GroundStation(tmp_path, f"udpin:127.0.0.1:{relay.ground_port}")
        stack.callback(station.end)
        vehicle = Vehicle(tmp_path, relay.vehicle_port, "--config", str(file), "--state", str(tmp_path))
        stack.callback(vehicle.end)
        rig = Rig(vehicle, relay, station)
        station.wait_for(lambda: b"no key" in station.screen, PATIENCE, "the header says that the key is missing")
        save_keys(station_key_file(), load_keys(tmp_path / FILE))
        station.wait_for(lambda: "keys changed: laptop" in station.log.read_text(), PATIENCE, "the key is taken over")
        rig.drive()
        before, host = len(vehicle.errors.read_text()), station_of(station)
        waits = Waits(vehicle.process.pid, *children(host))
        os.kill(host, signal.SIGKILL)
        relay.wait(vehicle.stands, PATIENCE, "the wheels stop")
        assert LOST not in vehicle.errors.read_text()[before:] or waits.total() > BUSY
