"""Views of the Map screen: the plans of the selected vehicle, their items page by page, and where vehicles are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dialects.enums import MissionType
from groundstation.formats.plan import from_vehicle, keeps_home
from groundstation.station.services.service_requests import ServiceRequests
from groundstation.station.view_feed import ViewSource
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.services import VehicleServices
from groundstation.views.base import ViewRequest
from groundstation.views.plan import (
    PAGE,
    Neighbour,
    PlanItem,
    PlanKind,
    PlanMode,
    PlanPage,
    PlanPageRequest,
    PlanRequest,
    PlanSummary,
    PlanTrackRequest,
    PlanTrackView,
    PlanView,
)
from groundstation.views.requests import RequestsRequest
from link.services.mission.items import MissionItem

NO_MISSION = 0xFFFF
"""Sequence in MISSION_CURRENT of a vehicle that has no mission."""


class PlanViews:
    """Builds the views, only while a screen watches them."""

    def __init__(self, fleet: Fleet, services: ServiceRequests) -> None:
        self._fleet = fleet
        self._services = services

    @property
    def sources(self) -> Mapping[type[ViewRequest], ViewSource]:
        """Request -> its source."""
        return {
            PlanRequest: ViewSource(self._build_plan, period=0.2),
            PlanPageRequest: ViewSource(self._build_page, period=0.05),
            PlanTrackRequest: ViewSource(self._build_track, period=1.0),
        }

    def _build_plan(self, request: PlanRequest, now: float, wall: float) -> PlanView | None:
        contact = self._fleet.selected
        if contact is None:
            return None
        state, details = contact.state, contact.details
        requests = self._services.build_requests(RequestsRequest(), now, wall)
        return PlanView(
            system=state.system,
            name=state.name,
            autopilot=state.autopilot,
            place=details.place,
            home=details.home,
            speed=contact.drive.plan_speed,
            charge=state.reading("battery_remaining"),
            charge_rate=_rounded(contact.drive.battery_use.rate),
            neighbours=tuple(self._neighbours(contact)),
            running=tuple(each for each in requests.running if _ours(each.service, each.system, contact)),
            ended=tuple(each for each in requests.ended if _ours(each.service, each.system, contact)),
            **_plan_fields(contact.services, now),
        )

    def _build_page(self, request: PlanPageRequest, now: float, wall: float) -> PlanPage | None:
        contact = self._fleet.selected
        if contact is None or contact.services is None or contact.state.system != request.system:
            return None
        if request.kind not in PlanKind._value2member_map_:
            return None
        services, kind = contact.services, MissionType(request.kind)
        plan = from_vehicle(services.plans.plans.get(kind, ()), kind, services.autopilot).of(kind)
        version, first = services.plans.versions.get(kind, 0), max(0, request.first)
        items = tuple(map(_item, plan[first : first + PAGE]))
        return PlanPage(contact.state.system, request.kind, version, len(plan), first, items)

    def _build_track(self, request: PlanTrackRequest, now: float, wall: float) -> PlanTrackView | None:
        contact = self._fleet.selected
        if contact is None:
            return None
        details = contact.details
        return PlanTrackView(contact.state.system, details.origin, details.track.points)

    def _neighbours(self, selected: Contact) -> list[Neighbour]:
        others = ((each.state.system, each.details.place) for each in self._fleet if each is not selected)
        return [Neighbour(system, place) for system, place in others if place is not None]


def _rounded(rate: float | None) -> float | None:
    """Return a rate with two digits, so that the view changes no more often than what it says."""
    return None if rate is None else float(f"{rate:.1e}")


def _plan_fields(services: VehicleServices | None, now: float) -> dict[str, Any]:
    """Return what only a vehicle with services has: nothing was requested of others."""
    if services is None:
        return {}
    progress, first = services.progress, int(keeps_home(services.autopilot))
    nav, current = progress.nav_output(now), progress.current
    known = current is not None and current != NO_MISSION and current >= first
    return {
        "first": first,
        "plans": tuple(_summary(services, kind) for kind in PlanKind),
        "current": current - first if known and current is not None else None,
        "reached": tuple(seq - first for seq in progress.reached if seq >= first),
        "state": progress.state,
        "off_line": None if nav is None else round(nav.xtrack_error, 2),
        "home_altitude": progress.home_altitude,
        "modes": tuple(PlanMode(mode.name, mode.moves_itself) for mode in services.modes.modes if mode.selectable),
    }


def _summary(services: VehicleServices, kind: PlanKind) -> PlanSummary:
    mission_type, plans = MissionType(kind), services.plans
    items = from_vehicle(plans.plans.get(mission_type, ()), mission_type, services.autopilot).of(mission_type)
    changed = _is_changed(bool(items), plans.ids.get(mission_type, 0), services.progress.ids, kind)
    version = plans.versions.get(mission_type, 0)
    return PlanSummary(version, len(items), bool(version) and changed)


def _is_changed(has_items: bool, known: int, reported: tuple[int, int, int] | None, kind: PlanKind) -> bool:
    """Return whether the vehicle reports another id than that of the plan that is known here.

    A plan with items and without an id: the vehicle told none in MISSION_ACK, so that nothing can be compared.
    """
    if reported is None or (has_items and not known):
        return False
    return known != reported[kind]


def _ours(service: str, system: int, contact: Contact) -> bool:
    return service == "plan" and system == contact.state.system


def _item(item: MissionItem) -> PlanItem:
    return PlanItem(item.command, item.frame, item.params, item.x, item.y, item.z, item.autocontinue)
