"""The Drive screen's part of the snapshot, and its views, for the selected vehicle."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dialects.enums import MissionType
from dialects.messages import Heartbeat, Message, RoverDriveStatus
from groundstation.station.driving.operator import OperatorSession
from groundstation.station.view_feed import ViewSource
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.stops.stop_bounds import stop_bounds
from groundstation.views.base import ViewRequest
from groundstation.views.drive import SpeedRequest, SpeedView, TrackRequest, TrackView
from link.core import Received
from link.services.timesync import TimesyncClient

DEMANDS_COUNT = 10.0
"""s after which an old demand of ours is none of the vehicle's any more."""


class DriveDisplay:
    """Joins what the vehicle tells with what this station sends to it. `system` is our system id."""

    def __init__(self, fleet: Fleet, operator: OperatorSession, timesync: TimesyncClient, system: int) -> None:
        self._fleet = fleet
        self._system = system
        self._operator = operator
        self._timesync = timesync
        self._beat_at: float | None = None

    @property
    def sources(self) -> dict[type[ViewRequest], ViewSource]:
        """Request -> its source."""
        return {
            TrackRequest: ViewSource(self._build_track, period=0.2),
            SpeedRequest: ViewSource(self._build_speeds, period=0.5),
        }

    def receive(self, contact: Contact, received: Received, now: float) -> None:
        """Handle a message of a vehicle."""
        contact.drive.receive(received, self._round_trip(contact), now)
        message = received.message
        if isinstance(message, RoverDriveStatus) and message.source_system == self._system:
            contact.state.latency.record_applied(message.source_seq, now, message.demand_age_ms / 1000)

    def tick(self, now: float) -> None:
        """Choose the parameters to read, and add to the series."""
        for contact in self._fleet:
            contact.drive.tick(now)
            self._measure_drift(contact, now)

    def _measure_drift(self, contact: Contact, now: float) -> None:
        state, ours = contact.state, contact is self._fleet.selected and contact.demand_stream.streaming
        rests = ours and state.in_air and state.mode in state.model.keys and not self._operator.moves
        speed = state.speed_over_ground if state.monitor.is_alive(now) else None
        contact.drive.drift.add(speed, now, rests=rests)

    def handle_sent(self, message: Message, now: float) -> None:
        """Record that a message was sent."""
        if isinstance(message, Heartbeat):
            self._beat_at = now

    def build_fields(self, contact: Contact, now: float) -> dict[str, Any]:
        """Build the fields of VehicleView."""
        drive, state, services = contact.drive, contact.state, contact.services
        plan = services.plans.plans.get(MissionType.MISSION, ()) if services is not None else ()
        age = drive.command_age(self._demand_age(contact, now), self._round_trip(contact), now)
        settings: Mapping[str, float] = contact.settings_check.values if contact.settings_check else {}
        facts = drive.build_facts(settings, age, self._quiet(contact, now), self._input_age(contact, now), now)
        return {
            "link_loss_action": contact.link_loss_action,
            "obeys": contact.settings_check.obeys if contact.settings_check else None,
            "warnings": contact.warnings,
            "command_age": age[0],
            "command_age_estimated": age[1] and age[0] is not None,
            "speed_demand": drive.speed_demand(now),
            "stops": stop_bounds(drive.rules, facts),
            **drive.flight_limits(),
            "drift": drive.drift.speed(now),
            "battery_left": drive.battery_left,
            "health": drive.health.build_lines(now),
            "mission": drive.mission.build(
                plan, contact.details.place, state.speed, navigates=state.drives_itself, now=now
            ),
        }

    def _round_trip(self, contact: Contact) -> float | None:
        return self._timesync.round_trip if contact is self._fleet.selected else None

    def _demand_age(self, contact: Contact, now: float) -> float | None:
        age = now - contact.demanded_at
        return age if age <= DEMANDS_COUNT else None

    def _quiet(self, contact: Contact, now: float) -> float | None:
        """Return the time since the newest message to the vehicle."""
        sent = contact.demanded_at if self._beat_at is None else max(self._beat_at, contact.demanded_at)
        return now - sent if now - sent < 3600.0 else None

    def _input_age(self, contact: Contact, now: float) -> float | None:
        """Return the age of the newest key event while a demand moves the vehicle."""
        moves = self._operator.moves and not contact.state.drives_itself
        return self._operator.inputs.age(now) if moves else None

    # ---- views ----

    def _build_track(self, request: TrackRequest, now: float, wall: float) -> TrackView | None:
        selected = self._fleet.selected
        return TrackView(selected.state.system, selected.state.trail.points) if selected else None

    def _build_speeds(self, request: SpeedRequest, now: float, wall: float) -> SpeedView | None:
        selected = self._fleet.selected
        return SpeedView(selected.state.system, selected.drive.speeds.points) if selected else None
