"""The two programs and the network between them, started for a test and ended with it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from tests.e2e import programs
from tests.e2e.programs import GroundStation, Vehicle
from tests.e2e.relay import Relay
from tests.soak.signing import make_keys
from tests.waits import Waits


@dataclass
class Rig:
    """Vehicle, relay and ground station."""

    vehicle: Vehicle
    relay: Relay
    station: GroundStation
    obeying: Waits = field(init=False)
    """How long the machine delayed the vehicle and the relay since the last `watch`."""
    asking: Waits = field(init=False)
    """The same, with the ground station."""

    def drive(self) -> None:
        """Arm and hold `i` until the wheels turn, then start to watch."""
        programs.drive(self.station, self.vehicle, self.relay.armed)
        self.watch()
        # Counting took some time; the stop must follow at once. A busy machine may have ended in HOLD meanwhile.
        if not self.station.held("i", self.vehicle.at_full, 5.0):
            programs.drive_on(self.station, self.vehicle)

    def watch(self) -> None:
        """Count the delays of the machine from now on."""
        self.obeying = Waits(self.vehicle.process.pid)
        self.asking = Waits(self.vehicle.process.pid, self.station.process.pid)


@pytest.fixture
def keys(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[str, ...]:
    """Return the options of a vehicle that ignores what is not signed, if MAVHELM_SIGNED asks for it; else none."""
    if "MAVHELM_SIGNED" not in os.environ:
        return ()
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    return make_keys(tmp_path)


@pytest.fixture
def rig(tmp_path: Path, keys: tuple[str, ...]) -> Iterator[Callable[..., Rig]]:
    """Return a function that builds a rig; keyword arguments go to the Relay (loss, delay), `options` to the ground
    station."""
    with ExitStack() as stack:

        def build(*options: str, **network: float) -> Rig:
            relay = Relay(**network)
            stack.callback(relay.close)
            station = GroundStation(tmp_path, f"udpin:127.0.0.1:{relay.ground_port}", *options)
            stack.callback(station.end)
            vehicle = Vehicle(tmp_path, relay.vehicle_port, *keys)
            stack.callback(vehicle.end)
            return Rig(vehicle, relay, station)

        yield build
