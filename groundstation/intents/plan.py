"""Intents about the plans of a vehicle, and where it drives by itself."""

from __future__ import annotations

from groundstation.geo import Place
from groundstation.intents.services import ServiceIntent
from groundstation.views.plan import PlanItem


class DownloadPlan(ServiceIntent, frozen=True, tag=True):
    """Download a plan."""

    open_to_all = True

    kind: int = 0
    """PlanKind."""


class UploadPlan(ServiceIntent, frozen=True, tag=True):
    """Replace a plan; the old one stays until the vehicle has accepted the whole new one."""

    kind: int = 0
    items: tuple[PlanItem, ...] = ()
    home: Place | None = None
    """Planned home, for an autopilot that keeps home as an item."""
    home_altitude: float = 0.0
    """m above sea level."""


class ClearPlan(ServiceIntent, frozen=True, tag=True):
    """Clear a plan on the vehicle."""

    kind: int = 0


class StartMission(ServiceIntent, frozen=True, tag=True):
    """Start the mission, or go on with it where it was paused."""


class PauseMission(ServiceIntent, frozen=True, tag=True):
    """Stop where the vehicle is; the mission can go on."""


class JumpToItem(ServiceIntent, frozen=True, tag=True):
    """Make another mission item the current one."""

    index: int = 0
    """From 0, without home."""


class EnableFence(ServiceIntent, frozen=True, tag=True):
    """Switch the fence on or off."""

    on: bool = True


class GoTo(ServiceIntent, frozen=True, tag=True):
    """Drive to a place now."""

    place: Place = Place(0.0, 0.0)


class SetHome(ServiceIntent, frozen=True, tag=True):
    """Move home to a place."""

    place: Place = Place(0.0, 0.0)


class ChooseMode(ServiceIntent, frozen=True, tag=True):
    """Change to a mode by the name that the vehicle gives it."""

    mode: str = ""
