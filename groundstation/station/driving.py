"""May the keys drive the vehicle now, if not why not, and the demands that go to it."""

from __future__ import annotations

from dialects.axes import NEUTRAL, Axes, axis_map, build_manual_control
from dialects.messages import ManualControl, Message
from dialects.modes import Mode
from groundstation.station.commander import Commander
from groundstation.station.operator import OperatorSession
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.vehicle_state import VehicleState
from link.core import Outgoing

DRIVABLE_MODES = frozenset({"MANUAL", "ACRO", "STEERING", "SIMPLE", "STABILIZED", "ALTCTL", "POSCTL"})
"""Modes in which the driver's demand moves a rover (ArduRover's and PX4's names)."""


STANDING_MODES = frozenset({Mode.HOLD.name, Mode.INITIALISING.name})
"""Modes in which nothing moves a rover."""


def is_autonomous(state: VehicleState) -> bool:
    """Does the vehicle, or something on board, decide where it goes?"""
    return state.armed and state.mode not in DRIVABLE_MODES | STANDING_MODES


class DrivingController:
    """Joins the operator with the selected vehicle. `system` is ours."""

    def __init__(self, operator: OperatorSession, fleet: Fleet, commander: Commander, system: int) -> None:
        self.ending = False
        """Quit was asked: neutral, and then nothing more."""
        self._operator = operator
        self._fleet = fleet
        self._commander = commander
        self._system = system
        self._demands: dict[int, list[Message]] = {}
        """Newest demand a vehicle, with its proof of life: state, so a newer one replaces it."""
        self._changed: ManualControl | None = None
        self._changed_at = 0.0
        """When the demand in `_changed` was asked for: what we need to send it is part of the latency."""

    def update(self, now: float) -> None:
        """Make the demands that are due."""
        self.update_permission(now)
        demand = self._operator.demand(now)
        for contact in self._fleet:
            chosen = contact is self._fleet.selected
            axes = contact.demand_stream.next_due(
                demand if chosen else NEUTRAL, chosen and self._may_stream(contact), now
            )
            if axes is not None:
                self._queue_demand(contact, axes, now)

    def update_permission(self, now: float) -> None:
        """Notice when keys begin to drive, and when they may no more: before a key is taken, and with each advance."""
        if (
            self._operator.set_driving_allowed(self.blocked_reason(now) is None, now)
            and self._fleet.selected is not None
        ):
            self._fleet.selected.demand_stream.resume(now)

    def messages_to_send(self) -> list[Outgoing]:
        """The demands to send now; empties what it returns."""
        demands, self._demands = self._demands, {}
        return [Outgoing(message) for messages in demands.values() for message in messages]

    def sent(self, message: Message, sequence: int, now: float) -> None:
        """A message went out under this packet sequence."""
        if not isinstance(message, ManualControl):
            return
        self._operator.demand_rate.add(now)
        contact = self._fleet.get(message.target)
        if message is self._changed and contact is not None:
            contact.state.latency.record_sent(sequence, self._changed_at)

    @property
    def finished(self) -> bool:
        """Nothing is sent and nothing is left to be said."""
        return not self._demands and all(contact.demand_stream.finished for contact in self._fleet)

    def is_in_control(self, contact: Contact) -> bool:
        """Do we control this vehicle: as it says itself, else since it obeyed us."""
        state = contact.state
        return state.system in self._commander.claimed if state.driver is None else state.driver == self._system

    def blocked_reason(self, now: float) -> str | None:
        """Why keys do not drive now, in words for the driver; None when they do."""
        contact = self._fleet.selected
        obstacle = "quitting" if self.ending else self._operator.blocked_reason(now)
        if obstacle or contact is None:
            return obstacle or "no vehicle"
        return self._vehicle_blocked_reason(contact, now)

    def _vehicle_blocked_reason(self, contact: Contact, now: float) -> str | None:
        state = contact.state
        if self._commander.is_locked(state.system) or state.emergency_stop:
            return "emergency stop"
        if not state.monitor.is_alive(now):
            return f"{state.name} is silent"
        if not state.armed:
            return "arming" if self._commander.is_arming(state.system) else "disarmed"
        if not self.is_in_control(contact):
            return f"station {state.driver} is in control" if state.driver else "not in control"
        return None if state.mode in DRIVABLE_MODES else f"mode {state.mode}"

    def _may_stream(self, contact: Contact) -> bool:
        """Demands go only to a vehicle that is armed and ours: an idle station must not fight another driver."""
        state = contact.state
        if self.ending or not self._operator.live:
            return False
        if self._commander.is_arming(state.system):
            return state.driver in (None, self._system)
        return state.armed and self.is_in_control(contact)

    def _queue_demand(self, contact: Contact, axes: Axes, now: float) -> None:
        state = contact.state
        message = build_manual_control(axes, state.system, axis_map(state.autopilot))
        messages: list[Message] = [message]
        if contact is self._fleet.selected:
            if axes != self._operator.sent_demand:
                self._changed, self._changed_at = message, now
                messages.append(message)  # lost alone it would wait 50 ms for the next beat; twice at 5 % is 1 in 400
            self._operator.sent_demand = axes
        if state.has_rover_dialect:
            proof = self._operator.build_presence((state.system, state.component), state.boot_time, now)
            messages.insert(0, proof)
        self._demands[state.system] = messages
