"""Intents about the plans of a vehicle, and where it drives by itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.geo import Place
from groundstation.intents.services import ServiceIntent
from groundstation.views.plan import PlanItem

if TYPE_CHECKING:
    from groundstation.vehicles.services import VehicleServices


class DownloadPlan(ServiceIntent, frozen=True, tag=True):
    """Download a plan."""

    service, what = "plan", "download a plan"
    open_to_all = True

    kind: int = 0
    """PlanKind."""

    def start(self, services: VehicleServices, now: float) -> None:
        services.plans.download(self.request, self.kind, now)


class UploadPlan(ServiceIntent, frozen=True, tag=True):
    """Replace a plan; the old one stays until the vehicle has accepted the whole new one."""

    service, what = "plan", "upload a plan"

    kind: int = 0
    items: tuple[PlanItem, ...] = ()
    home: Place | None = None
    """Planned home, for an autopilot that keeps home as an item."""
    home_altitude: float = 0.0
    """m above sea level."""

    def start(self, services: VehicleServices, now: float) -> None:
        services.plans.upload_edited(self, services.autopilot, now)


class ClearPlan(ServiceIntent, frozen=True, tag=True):
    """Clear a plan on the vehicle."""

    service, what = "plan", "clear a plan"

    kind: int = 0

    def start(self, services: VehicleServices, now: float) -> None:
        services.plans.clear(self.request, self.kind, now)


class StartMission(ServiceIntent, frozen=True, tag=True):
    """Start the mission, or go on with it where it was paused."""

    service, what = "plan", "start the mission"

    def start(self, services: VehicleServices, now: float) -> None:
        services.missions.start(self.request, now)


class PauseMission(ServiceIntent, frozen=True, tag=True):
    """Stop where the vehicle is; the mission can go on."""

    service, what = "plan", "pause the mission"

    def start(self, services: VehicleServices, now: float) -> None:
        services.missions.pause(self.request, now)


class JumpToItem(ServiceIntent, frozen=True, tag=True):
    """Make another mission item the current one."""

    service, what = "plan", "jump to an item"

    index: int = 0
    """From 0, without home."""

    def start(self, services: VehicleServices, now: float) -> None:
        services.missions.jump(self.request, self.index, now)


class EnableFence(ServiceIntent, frozen=True, tag=True):
    """Switch the fence on or off."""

    service, what = "plan", "switch the fence"

    on: bool = True

    def start(self, services: VehicleServices, now: float) -> None:
        services.missions.enable_fence(self.request, now, on=self.on)


class GoTo(ServiceIntent, frozen=True, tag=True):
    """Drive to a place now."""

    service, what = "plan", "go to a place"

    place: Place = Place(0.0, 0.0)

    def start(self, services: VehicleServices, now: float) -> None:
        services.missions.go_to(self.request, self.place.latitude, self.place.longitude, now)


class SetHome(ServiceIntent, frozen=True, tag=True):
    """Move home to a place."""

    service, what = "plan", "set home"

    place: Place = Place(0.0, 0.0)

    def start(self, services: VehicleServices, now: float) -> None:
        services.missions.set_home(self.request, self.place.latitude, self.place.longitude, now)


class ChooseMode(ServiceIntent, frozen=True, tag=True):
    """Change to a mode by the name that the vehicle gives it."""

    service, what = "plan", "change the mode"

    mode: str = ""

    def start(self, services: VehicleServices, now: float) -> None:
        services.modes.set(self.request, self.mode, now)
