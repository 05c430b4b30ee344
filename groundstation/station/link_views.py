"""Views of the Links screen: all vehicles, all links, and who is in control of the selected vehicle."""

from __future__ import annotations

from collections.abc import Mapping

from dialects import messages as m
from dialects.enums import Command, ControlFlag, state_name
from groundstation.station.commander import Commander
from groundstation.station.driving import DrivingController
from groundstation.station.ground_stations import GroundStations
from groundstation.station.handover import Handover
from groundstation.station.link_stats import LinkStats
from groundstation.station.view_feed import ViewSource
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.vehicle_details import Place, VehicleDetails, find_way
from groundstation.views import (
    ControlRequest,
    ControlView,
    LinksRequest,
    LinksView,
    Program,
    VehicleRow,
    VehiclesRequest,
    VehiclesView,
    ViewRequest,
)
from link.services.timesync import TimesyncClient

PERIOD = 0.5
"""s between two views: tables change all their lines, which is expensive over SSH."""

VERSION_TRIES, VERSION_PERIOD = 3, 2.0
"""How often AUTOPILOT_VERSION is requested of a vehicle, and s between: a vehicle may accept and not send it."""

TAKEOVER_ALLOWED = 2
"""GCS_CONTROL_STATUS_FLAGS of CONTROL_STATUS."""


class LinkViews:
    """Builds the three views, only while the screen watches them. `ours` is this station."""

    def __init__(
        self,
        fleet: Fleet,
        commander: Commander,
        driving: DrivingController,
        handover: Handover,
        links: LinkStats,
        timesync: TimesyncClient,
        ours: Program,
    ) -> None:
        self.stations = GroundStations()
        self._fleet = fleet
        self._commander = commander
        self._driving = driving
        self._handover = handover
        self._links = links
        self._timesync = timesync
        self._ours = ours
        self._versions: dict[int, tuple[int, float]] = {}
        """System id -> how often its AUTOPILOT_VERSION was requested, and when it may be again."""

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
            self._request_version(contact, now)
        contacts = sorted(self._fleet, key=lambda contact: contact.state.system)
        return VehiclesView(tuple(self._vehicle(contact, now) for contact in contacts), self._fleet.not_shown)

    def _vehicle(self, contact: Contact, now: float) -> VehicleRow:
        state, details = contact.state, contact.details
        view = state.build_view(now)
        way = find_way(self._origin(contact), details.place)
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
            driver=state.driver,
            components=details.components(now),
        )

    def _origin(self, contact: Contact) -> Place | None:
        """Return from where the vehicle is seen: from the selected one, and that one from its home."""
        selected = self._fleet.selected
        if selected is None or selected is contact:
            return contact.details.home
        return selected.details.place

    def _request_version(self, contact: Contact, now: float) -> None:
        state = contact.state
        tries, due = self._versions.get(state.system, (0, now))
        wanted = not contact.details.firmware and contact.lost_at is None and tries < VERSION_TRIES and now >= due
        if wanted and not self._commander.is_pending(Command.REQUEST_MESSAGE, state):
            self._versions[state.system] = (tries + 1, now + VERSION_PERIOD)
            self._commander.request_message(state, m.AutopilotVersion.id, now)

    # ---- links ----

    def _build_links(self, request: LinksRequest, now: float, wall: float) -> LinksView:
        selected = self._fleet.selected
        link = None if selected is None else selected.link
        round_trip, jitter = self._timesync.round_trip, self._timesync.jitter
        return LinksView(self._links.build_rows(round_trip, jitter, link, self._fleet.system_ids))

    # ---- control ----

    def _build_control(self, request: ControlRequest, now: float, wall: float) -> ControlView:
        stations, signing = self.stations.build_rows(now), self._links.signing
        contact = self._fleet.selected
        if contact is None:
            return ControlView(vehicle="", ours=self._ours, stations=stations, signing=signing)
        flags = _flags(contact.details)
        waits = self._handover.waits_for(contact, now)
        return ControlView(
            vehicle=contact.state.name,
            ours=self._ours,
            in_control=self._driving.is_in_control(contact),
            driver=contact.state.driver,
            program=_program(contact.details),
            age=_age(contact.details, now),
            takeover=ControlFlag.TAKEOVER_ALLOWED in flags,
            clash=ControlFlag.CLASH in flags,
            silent=ControlFlag.SILENT in flags,
            waits=None if waits is None else round(waits),
            stations=stations,
            signs=contact.signs,
            signing=signing,
        )


def _program(details: VehicleDetails) -> Program | None:
    if details.control is None or not details.control.message.driver_system:
        return None
    message = details.control.message
    return Program(message.driver_system, message.driver_component, message.session_id)


def _flags(details: VehicleDetails) -> ControlFlag:
    """Return the flags of ROVER_CONTROL; CONTROL_STATUS has one of them, for vehicles that send nothing else."""
    if details.control is not None:
        return ControlFlag(details.control.message.flags & ALL_FLAGS)
    status = details.control_status
    allowed = status is not None and bool(status.flags & TAKEOVER_ALLOWED)
    return ControlFlag.TAKEOVER_ALLOWED if allowed else ControlFlag(0)


ALL_FLAGS = ControlFlag.TAKEOVER_ALLOWED | ControlFlag.CLASH | ControlFlag.SILENT


def _age(details: VehicleDetails, now: float) -> float | None:
    """Return the age of the newest report of who is in control."""
    if details.control_status is None and details.control is None:
        return None
    control_at = details.control.at if details.control is not None else details.control_status_at
    return round(now - max(control_at, details.control_status_at), 1)
