"""SnapshotBuilder: what every screen shows, from the parts of the core. It changes nothing."""

from __future__ import annotations

from groundstation.snapshot import Snapshot, VehicleView
from groundstation.station.core_parts import CoreParts
from groundstation.station.views.drive_display import DriveDisplay
from groundstation.vehicles.fleet import Contact


class SnapshotBuilder:
    """Joins what vehicles report with what this station has requested of them."""

    def __init__(self, parts: CoreParts, display: DriveDisplay) -> None:
        self._parts = parts
        self._display = display

    def build(self, now: float, wall: float, *, faults: int) -> Snapshot:
        """Build the snapshot; `faults`: how many links of the doctor's chain stop the operator."""
        parts, links, fleet, around = self._parts, self._parts.links, self._parts.fleet, self._parts.links.station_info
        selected = fleet.selected
        return Snapshot(
            uptime=now - parts.started,
            endpoints=around.endpoints,
            addresses=around.addresses,
            waiting=None if selected else around.waiting(has_traffic=links.stats.has_traffic),
            vehicle=self._vehicle(selected, now) if selected else None,
            left_armed=parts.shutdown.left_armed(now),
            end_armed=parts.shutdown.end_armed(around.simulated, now),
            id_conflict=links.id_conflict.text(now),
            free_id=links.stations.free_id(parts.ids[0], fleet.system_ids),
            blind_stop=parts.commander.blind_stops.describe(),
            vehicles=fleet.system_ids,
            not_shown=fleet.not_shown,
            also_armed=fleet.also_armed,
            handover=parts.handover.notice(now),
            operator=parts.operator.build_view(
                parts.driving.judge(now).reason, bool(selected and selected.demand_stream.streaming), now
            ),
            proposal=parts.proposals.view(now),
            links=links.stats.build_views(links.find_figures(selected, now)),
            signing=fleet.signing_of(selected, now),
            texts=parts.log.build_lines(now, wall),
            faults=faults,
            recording=around.recording,
            simulator=around.simulator,
            transfers=parts.services.progress,
            rests=parts.operator.rests,
        )

    def _vehicle(self, contact: Contact, now: float) -> VehicleView:
        state, commander, driving = contact.state, self._parts.commander, self._parts.driving
        fence = contact.altitude_fence
        return state.build_view(
            now,
            in_control=driving.is_in_control(contact),
            duplicate_gcs=driving.is_driven_by_duplicate_gcs(contact),
            control_wait=self._parts.handover.waits_for(contact, now),
            emergency_stop=state.emergency_stop or commander.is_locked(state.system),
            emergency_progress=None if state.emergency_stop else commander.emergency_progress(state.system, now),
            stop_question=commander.stop_question(state.system, now),
            stop_doubt=commander.stop_doubt(state.system, now),
            duplicates=state.senders.describe_duplicates(now),
            take_off=commander.take_off_altitude if state.model.flies else None,
            altitude_fence=None if fence is None else fence.highest,
            refusal=commander.last_refusal(state.system, now),
            **self._display.build_fields(contact, now),
        )
