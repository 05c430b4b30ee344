"""Control of vehicles that send no CONTROL_STATUS, inferred from their acceptance of our commands.

A claim ends when the vehicle disarms, or when it becomes armed without us: then another ground station drives it.
"""

from __future__ import annotations

import msgspec

from groundstation.station.driving.arming import CONFIRM_WITHIN
from groundstation.vehicles.state.vehicle_state import VehicleState


class _Claim(msgspec.Struct):
    vehicle: VehicleState
    seen_armed: bool
    """The vehicle has reported armed while this claim was held."""
    arms_until: float | None
    """Until when our own arming may show in the HEARTBEAT; None for a claim by a control request."""

    def holds(self, now: float) -> bool:
        """Return whether the claim is still valid; call after each message of the vehicle and with time."""
        arming = self.arms_until is not None and now <= self.arms_until
        if self.vehicle.armed:
            self.seen_armed = self.seen_armed or arming
            return self.seen_armed
        return not self.seen_armed and (arming or self.arms_until is None)


class Claims:
    """The vehicles that have accepted arming or a control request from us, and have not disarmed since."""

    def __init__(self) -> None:
        self._claims: dict[int, _Claim] = {}

    def __contains__(self, system: int) -> bool:
        return system in self._claims

    def add(self, vehicle: VehicleState, now: float, *, by_arming: bool) -> None:
        """Claim a vehicle that has accepted our command."""
        self._claims[vehicle.system] = _Claim(vehicle, vehicle.armed, now + CONFIRM_WITHIN if by_arming else None)

    def remove(self, system: int) -> None:
        """Give up the claim of a vehicle, if there is one."""
        self._claims.pop(system, None)

    def update(self, now: float) -> None:
        """Give up the claims that have ended."""
        for system, claim in list(self._claims.items()):
            if not claim.holds(now):
                del self._claims[system]
