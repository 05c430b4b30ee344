"""The two programs and the network between them, started for a test and ended with it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.e2e.programs import GroundStation, Vehicle
from tests.e2e.relay import Relay


class Rig(NamedTuple):
    """Vehicle - relay - ground station."""

    vehicle: Vehicle
    relay: Relay
    station: GroundStation


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Callable[..., Rig]]:
    """Builds a rig; keyword arguments go to the Relay (loss, delay), `options` to the ground station."""
    with ExitStack() as stack:

        def build(*options: str, **network: float) -> Rig:
            relay = Relay(**network)
            stack.callback(relay.close)
            station = GroundStation(tmp_path, f"udpin:127.0.0.1:{relay.ground_port}", *options)
            stack.callback(station.end)
            vehicle = Vehicle(tmp_path, relay.vehicle_port)
            stack.callback(vehicle.end)
            return Rig(vehicle, relay, station)

        yield build
