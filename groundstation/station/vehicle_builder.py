"""The selected vehicle as the snapshot shows it."""

from __future__ import annotations

from groundstation.snapshot import VehicleView
from groundstation.station.driving.commander import Commander
from groundstation.station.driving.driving import DrivingController
from groundstation.station.driving.handover import Handover
from groundstation.station.views.drive_display import DriveDisplay
from groundstation.vehicles.fleet import Contact


class VehicleBuilder:
    """Joins what the vehicle reports with what this station has requested of it."""

    def __init__(
        self, commander: Commander, driving: DrivingController, handover: Handover, display: DriveDisplay
    ) -> None:
        self._commander = commander
        self._driving = driving
        self._handover = handover
        self._display = display

    def build(self, contact: Contact, now: float) -> VehicleView:
        """Build the view of one vehicle."""
        state, commander = contact.state, self._commander
        return state.build_view(
            now,
            in_control=self._driving.is_in_control(contact),
            twin=self._driving.is_driven_by_twin(contact),
            control_wait=self._handover.waits_for(contact, now),
            emergency_stop=state.emergency_stop or commander.is_locked(state.system),
            emergency_progress=None if state.emergency_stop else commander.emergency_progress(state.system, now),
            stop_question=commander.stop_question(state.system, now),
            stop_doubt=state.senders.find_doubt(now) if commander.is_locked(state.system) else "",
            twins=state.senders.describe_twins(now),
            refusal=commander.last_refusal(state.system, now),
            **self._display.build_fields(contact, now),
        )
