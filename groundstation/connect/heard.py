"""HeardVehicles: vehicles whose heartbeats arrive on ports where nothing is sent. Time is an argument."""

from __future__ import annotations

from collections.abc import Hashable

from groundstation.vehicles.state.vehicle_heartbeat import is_vehicle, replaces
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.views.connect import HeardRow
from link.core import Received
from link.protocol.rate import RateMeter

FORGET_AFTER = 5.0
"""s without a message after which a vehicle is not listed any more."""

MAX_HEARD = 16
"""Vehicles that are listed: a flood of invented system ids must not grow the table."""


class _Sighting:
    """One vehicle at one address."""

    def __init__(self, state: VehicleState) -> None:
        self.state = state
        self.frames, self.size = RateMeter(2.0), RateMeter(2.0)
        self.at = 0.0


class HeardVehicles:
    """Vehicles by endpoint, address and system id."""

    def __init__(self) -> None:
        self._found: dict[tuple[str, Hashable, int], _Sighting] = {}

    def receive(self, endpoint: str, messages: list[Received], size: int, now: float) -> None:
        """Handle the messages of one datagram of `size` bytes."""
        for received in messages:
            key = (endpoint, received.peer.address, received.system)
            found = self._found.get(key)
            if found is None:
                if not is_vehicle(received.message) or len(self._found) >= MAX_HEARD:
                    continue
                found = self._found[key] = _Sighting(VehicleState(received.system, received.component))
            if replaces(received.component, found.state.component) and is_vehicle(received.message):
                found.state.change_component(received.component)
            found.state.receive(received, now)
            found.at = now
            found.frames.add(now)
            found.size.add(now, size / len(messages))

    def rows(self, now: float) -> tuple[HeardRow, ...]:
        """Return what is heard, by endpoint and system id."""
        self._found = {key: each for key, each in self._found.items() if now - each.at <= FORGET_AFTER}
        return tuple(_row(*key, each, now) for key, each in sorted(self._found.items(), key=lambda item: str(item[0])))

    def forget(self, endpoint: str) -> None:
        """Forget what was heard on one endpoint."""
        self._found = {key: each for key, each in self._found.items() if key[0] != endpoint}


def _row(endpoint: str, address: Hashable, system: int, found: _Sighting, now: float) -> HeardRow:
    return HeardRow(
        endpoint=endpoint,
        address=f"{address[0]}:{address[1]}" if isinstance(address, tuple) else "",
        system=system,
        name=found.state.name,
        mode=found.state.mode,
        armed=found.state.armed,
        silence=round(now - found.at, 1),
        rate=round(found.frames.rate(now)),
        bytes_per_second=round(found.size.rate(now)),
        driver=found.state.driver,
    )
