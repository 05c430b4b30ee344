"""What the watchdog must know of a vehicle to send it neutral in the place of this station."""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec

from dialects.kinds import find_kind

if TYPE_CHECKING:
    from groundstation.vehicles.state.vehicle_state import VehicleState

DEMAND_MEMORY = 3.0
"""s for which a vehicle may hold a demand (ArduPilot's RC_OVERRIDE_TIME); one without a demand for longer gets no
neutral."""


class WatchdogTarget(msgspec.Struct, frozen=True, kw_only=True):
    """A vehicle that got a demand from us within DEMAND_MEMORY."""

    system: int
    component: int
    name: str
    autopilot: int
    """MAV_AUTOPILOT: decides on the axes and their neutral, with `kind`."""
    kind: int
    """MAV_TYPE."""
    session: int | None = None
    """Our session, for a vehicle that takes its demands from ROVER_OPERATOR_PRESENCE; else None."""
    boot_time: int = 0
    """Newest time_boot_ms of the vehicle that we have seen."""
    verified: bool = False
    """It signs with a key of ours: what is not signed is not of it."""

    @property
    def flies(self) -> bool:
        """Whether neutral makes it hover."""
        return find_kind(self.autopilot, self.kind).flies

    @classmethod
    def of(cls, state: VehicleState, session: int, *, verified: bool = False) -> WatchdogTarget:
        """Return what the watchdog must know of a vehicle."""
        return cls(
            system=state.system,
            component=state.component,
            name=state.name,
            autopilot=state.autopilot,
            kind=state.kind,
            session=session if state.has_rover_dialect else None,
            boot_time=state.boot_time or 0,
            verified=verified,
        )
