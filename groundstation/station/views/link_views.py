"""Views of the Links screen: all vehicles, all links, and who is in control of the selected vehicle."""

from __future__ import annotations

from collections.abc import Mapping

from dialects.enums import state_name
from groundstation.geo import Place, find_separation
from groundstation.station.core_parts import CoreParts
from groundstation.station.view_feed import ViewSource
from groundstation.vehicles.fleet import Contact
from groundstation.vehicles.state.control_report import ControlReport
from groundstation.views.base import ViewRequest
from groundstation.views.links import (
    ControlRequest,
    ControlView,
    LinksRequest,
    LinksView,
    Program,
    VehicleRow,
    VehiclesRequest,
    VehiclesView,
)

PERIOD = 0.5
"""s between two views: tables change all their lines, which is expensive over SSH."""


class LinkViews:
    """Builds the three views, only while the screen watches them."""

    def __init__(self, parts: CoreParts) -> None:
        self._fleet = parts.fleet
        self._commander = parts.commander
        self._driving = parts.driving
        self._handover = parts.handover
        self._queries = parts.queries
        self._monitor, self._links = parts.links, parts.links.stats
        self._stations = parts.links.stations
        self._ours = Program(*parts.ids, parts.proofs.session)

    @property
    def sources(self) -> Mapping[type[ViewRequest], ViewSource]:
        """Request -> its source."""
        return {
            VehiclesRequest: ViewSource(self._build_vehicles, PERIOD),
            LinksRequest: ViewSource(self._build_links, PERIOD),
            ControlRequest: ViewSource(self._build_control, PERIOD),
        }

    # ---- vehicles ----

    def _build_vehicles(self, request: VehiclesRequest, now: float, wall: float) -> VehiclesView:
        for contact in self._fleet:
            self._queries.request_version(contact, now)
        contacts = sorted(self._fleet, key=lambda contact: contact.state.system)
        return VehiclesView(tuple(self._vehicle(contact, now) for contact in contacts), self._fleet.not_shown)

    def _vehicle(self, contact: Contact, now: float) -> VehicleRow:
        state, details = contact.state, contact.details
        view = state.build_view(now)
        way = find_separation(self._origin(contact), details.place)
        signing = self._fleet.signing_of(contact, now)
        return VehicleRow(
            system=state.system,
            name=state.name,
            firmware=details.firmware,
            mode=state.mode,
            armed=state.armed,
            emergency_stop=state.emergency_stop or self._commander.is_locked(state.system),
            alive=view.alive,
            silence=round(view.silence, 1),
            state=state_name(state.status),
            battery_voltage=None if view.battery_voltage is None else round(view.battery_voltage, 1),
            battery_remaining=view.battery_remaining,
            distance=None if way is None else round(way.distance, 1),
            bearing=None if way is None else round(way.bearing) % 360,
            has_position=details.place is not None,
            in_control=self._driving.is_in_control(contact),
            signing=signing.state.value if signing else "",
            driver=state.driver,
            components=details.components(now),
        )

    def _origin(self, contact: Contact) -> Place | None:
        """Return from where the vehicle is seen: from the selected one, and that one from its home."""
        selected = self._fleet.selected
        if selected is None or selected is contact:
            return contact.details.home
        return selected.details.place

    # ---- links ----

    def _build_links(self, request: LinksRequest, now: float, wall: float) -> LinksView:
        paths = self._monitor.find_figures(self._fleet.selected, now)
        return LinksView(self._links.build_rows(paths, self._monitor.timesync.jitter, self._fleet.system_ids))

    # ---- control ----

    def _build_control(self, request: ControlRequest, now: float, wall: float) -> ControlView:
        stations, signing = self._stations.build_rows(now), self._links.signing
        contact = self._fleet.selected
        if contact is None:
            return ControlView(
                vehicle="",
                ours=self._ours,
                stations=stations,
                signing=self._fleet.signing_of(None, now),
                signing_systems=signing,
            )
        control, at = contact.state.control, contact.details.control_at
        waits = self._handover.waits_for(contact, now)
        return ControlView(
            vehicle=contact.state.name,
            ours=self._ours,
            in_control=self._driving.is_in_control(contact),
            driver=control.driver,
            program=_program(control),
            age=None if at is None else round(now - at, 1),
            takeover=contact.details.takeover,
            clash=control.clash,
            silent=control.silent,
            waits=None if waits is None else round(waits),
            stations=stations,
            signing=self._fleet.signing_of(contact, now),
            signing_systems=signing,
        )


def _program(control: ControlReport) -> Program | None:
    if not control.driver or control.component is None:
        return None
    return Program(control.driver, control.component, control.session or 0)
