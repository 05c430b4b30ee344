"""Driving permission and demands: whether keys drive the selected vehicle, why not, which MANUAL_CONTROL to send."""

from __future__ import annotations

import math
from collections.abc import Callable

from dialects.axes import NEUTRAL, Axes, build_manual_control
from dialects.messages import ManualControl, Message, RcChannelsOverride, RoverOperatorPresence
from groundstation.input.style import Style
from groundstation.station.driving.commander import Commander
from groundstation.station.driving.driven import DEMAND_MEMORY, WatchdogTarget
from groundstation.station.driving.operator import OperatorSession
from groundstation.station.driving.permission import Permission
from groundstation.station.driving.proofs import IDLE_PROOF_PERIOD, SessionProofs
from groundstation.station.links.link_stats import LinkStats
from groundstation.station.outbox import StationOutbox
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.paths.paths import SILENCE
from groundstation.vehicles.readings.latency import SentDemand
from link.core import Outgoing

EARLY = 0.02
"""s by which a proof may be early: ticks come at the same period, and each of them a little late."""


class DrivingController:
    """Connects the operator with the selected vehicle. `ids` are our system and component id."""

    def __init__(
        self,
        operator: OperatorSession,
        proofs: SessionProofs,
        fleet: Fleet,
        commander: Commander,
        outbox: StationOutbox,
        ids: tuple[int, int],
    ) -> None:
        self._operator, self._proofs = operator, proofs
        self._fleet = fleet
        self.is_lent: Callable[[int, float], bool] = lambda system, now: False
        """Whether a verb makes the demands of this vehicle in the place of keys, while the operator holds one."""
        self._commander = commander
        self.report: Callable[[float, str], None] = lambda now, text: None
        """Logs what the driver must know."""
        self._ids = ids
        self._system = ids[0]
        self._ending = False
        self._demands = outbox.demands
        self._changed: tuple[Message, ...] = ()
        """The newest demand that was changed, and its copies."""
        self._proven_at = -math.inf
        """When the selected vehicle got the newest proof of this session."""
        self._changed_at = 0.0
        """When the demand in `_changed` was made: the time until it is sent is part of the latency."""
        self._changed_key: float | None = None
        """When the key was read that made it; None: a timer made it."""
        self.due_at: float | None = None
        """When `update` is due even if nothing happens before; None: at the next tick."""
        self._reported: dict[int, tuple[object, ...]] = {}
        """System id -> what its reports said of arming, mode, control and emergency stop."""
        self.key_read_at: float | None = None
        """When the key was read that is handled just now; None: there is none."""

    def judge(self, now: float) -> Permission:
        """Judge whether keys may drive. Called at the head of an event, and again when it may have changed that."""
        screen = self._operator.blocked_reason(now)
        controlled = frozenset(
            contact.state.system for contact in self._fleet if contact.state.armed and self.is_in_control(contact)
        )
        return Permission(screen, self._blocked_reason(screen, controlled, now), controlled)

    def apply(self, permission: Permission, now: float) -> None:
        """Let keys drive, or not."""
        if self._operator.set_driving_allowed(permission.reason is None, now) and self._fleet.selected is not None:
            self._fleet.selected.demand_stream.resume(now)

    def update(self, permission: Permission, now: float) -> None:
        """Apply a permission, and queue the demands that are due."""
        self.apply(permission, now)
        demand = self._operator.demand(now)
        due: list[float | None] = []
        selected = self._fleet.selected
        for contact in self._fleet:
            controlled = contact.state.system in permission.controlled
            self._update_ours(contact, controlled=controlled)
            if self.is_lent(contact.state.system, now):
                contact.demand_stream.resume(now)  # with neutral as soon as that ends
                continue
            chosen = contact is selected
            streaming = chosen and self._may_stream(contact, controlled=controlled)
            if self._follow_path(contact, now) and chosen:
                demand = self._operator.demand(now)
            axes = contact.demand_stream.next_due(demand if chosen else NEUTRAL, streaming, now)
            if axes is not None:
                self._queue_demand(contact, axes, now)
            due.append(contact.demand_stream.due_at)
            if chosen and contact.demand_stream.streaming:
                due.append(self._operator.changes_at(now))
        self.due_at = min((at for at in due if at is not None), default=None)
        self._queue_idle_proof(now)

    def handle_report(self, contact: Contact, now: float) -> None:
        """Run `update` at the next opportunity when a report changes whether demands are allowed."""
        state = contact.state
        reported = (state.armed, state.mode, state.driver, state.emergency_stop)
        if self._reported.get(state.system) != reported:
            self._reported[state.system] = reported
            self.due_at = now

    def adapt(self, links: LinkStats) -> None:
        """Adapt the copies of demands to the links of their vehicles. The loss is that of the other direction."""
        for contact in self._fleet:
            loss = links.loss(contact.link, contact.state.system)
            contact.demand_stream.adapt(loss, links.capacity(contact.link))

    def drop_demands(self) -> None:
        """Drop the demands that were made and not sent: they are from before a freeze."""
        self._demands.drop_all()

    def handle_sent(self, message: Message, sequence: int, now: float) -> None:
        """Record that a message was sent under this packet sequence number."""
        if isinstance(message, ManualControl | RcChannelsOverride):
            self._operator.demand_rate.add(now)
            target = message.target if isinstance(message, ManualControl) else message.target_system
            self._record_demand(target, now)
        elif isinstance(message, RoverOperatorPresence):
            target = message.target_system
        else:
            return
        contact = self._fleet.get(target)
        if contact is not None and any(message is changed for changed in self._changed):
            key = None if self._changed_key is None else max(0.0, now - self._changed_key)
            demand = SentDemand(self._changed_at, now, key)
            contact.state.latency.record_sent(sequence, demand)
            contact.drive.steps.record_sent(demand)

    def _record_demand(self, system: int, now: float) -> None:
        contact = self._fleet.get(system)
        if contact is not None:
            contact.demanded_at = now

    def driven_vehicles(self, now: float) -> tuple[WatchdogTarget, ...]:
        """Return the vehicles that may still hold a demand of ours."""
        return tuple(
            WatchdogTarget.of(contact.state, self._proofs.session, verified=contact.verified)
            for contact in self._fleet
            if now - contact.demanded_at <= DEMAND_MEMORY and contact.state.model.is_driven
        )

    def end(self) -> None:
        """Stop driving for good: neutral, then no more demands."""
        self._ending = True

    @property
    def ending(self) -> bool:
        """`end` was called."""
        return self._ending

    @property
    def finished(self) -> bool:
        """No demand is being sent and none is left to send."""
        return not self._demands.waiting and all(contact.demand_stream.finished for contact in self._fleet)

    def is_in_control(self, contact: Contact) -> bool:
        """Return whether we control this vehicle: by what it reports, else by its acceptance of our commands."""
        state = contact.state
        accepted = self._commander.is_claimed(state.system)
        return state.control.is_program(self._ids, self._proofs.session, accepted=accepted)

    def is_driven_by_duplicate_gcs(self, contact: Contact) -> bool:
        """Return whether another program with our system id controls this vehicle."""
        return contact.state.driver == self._system and not self.is_in_control(contact)

    def _blocked_reason(self, screen: str | None, controlled: frozenset[int], now: float) -> str | None:
        """Return why keys do not drive now, as a text for the driver; None when they do."""
        contact = self._fleet.selected
        obstacle = "quitting" if self._ending else screen
        if obstacle or contact is None:
            return obstacle or "no vehicle"
        in_control = contact.state.system in controlled
        return contact.state.model.refusal or self._vehicle_blocked_reason(contact, now, in_control=in_control)

    def _vehicle_blocked_reason(self, contact: Contact, now: float, *, in_control: bool) -> str | None:
        state = contact.state
        if self._commander.is_locked(state.system) or state.emergency_stop:
            return "emergency stop"
        if not state.monitor.is_alive(now):
            return f"{state.name}: link lost"
        if not state.armed:
            return "arming" if self._commander.is_arming(state.system) else "disarmed"
        if state.control.clash:
            return f"another program uses our id {self._system}"
        if not in_control:
            if state.driver == self._system:
                return f"another program with our id {self._system} is in control"
            return f"GCS {state.driver} is in control" if state.driver else "not in control"
        if contact.releasing or contact.closing:
            return "releasing control" if contact.releasing else "its link is being closed"
        return f"mode {state.mode}" if state.mode not in state.model.keys else self._flight_reason(contact)

    def _flight_reason(self, contact: Contact) -> str | None:
        """Return why keys do not fly what could be flown in this mode; None for what does not fly."""
        if not contact.state.model.flies:
            return None
        if self._operator.sticks.style is not Style.HOLD:
            return f"style {self._operator.sticks.style}: it flies by held keys only"
        return None if contact.state.in_air else (contact.take_off_refusal or None)

    def _may_stream(self, contact: Contact, *, controlled: bool) -> bool:
        """Return whether demands go to this vehicle: only if armed and ours, so as not to fight another driver.

        A silent driver with our system id is this program before a restart: neutral demands take over from it.
        """
        state = contact.state
        if self._ending or contact.releasing or contact.closing or not self._operator.live:
            return False
        if not state.model.is_driven or (state.armed and not state.model.takes_neutral(state.mode)):
            return False
        if self._commander.is_arming(state.system):
            return state.driver in (None, self._system)
        follows = state.armed and state.driver == self._system and state.control.silent
        return controlled or follows

    def _follow_path(self, contact: Contact, now: float) -> bool:
        """Let the demands of a vehicle that proves nothing take another path after a silence; return whether they do.

        Neutral first, on both: what waits in the silent link then ends in neutral, and keys must be pressed again.
        """
        paths = contact.state.paths
        if not paths.has_several or paths.best is None or contact.state.has_rover_dialect:
            return False
        before = paths.carrier.path
        if not paths.carrier.follow(paths.best, now, SILENCE) or before is None or contact.demand_stream.finished:
            return False
        if contact is self._fleet.selected:
            self._operator.reset_demand(now)
        self._demands.drop(contact.state.system)
        neutral = build_manual_control(NEUTRAL, contact.state.system, contact.choose_axes(NEUTRAL))
        self._demands.first.append(Outgoing(neutral, among=(before.peer, paths.best.peer)))
        self.report(now, f"{contact.state.name}: its link is silent, demands take another one: release the keys first")
        return True

    def _update_ours(self, contact: Contact, *, controlled: bool) -> None:
        """Note which vehicles this station has armed or drives; until the vehicle reports disarmed."""
        state = contact.state
        if self._commander.is_arming(state.system) or (controlled and state.model.is_driven):
            contact.ours = True
        elif not state.armed:
            contact.ours = False

    def _queue_demand(self, contact: Contact, axes: Axes, now: float) -> None:
        state, copying = contact.state, contact.demand_stream.copying
        if copying and state.system in self._demands:
            return  # what it would copy is not sent yet
        message = build_manual_control(axes, state.system, contact.choose_axes(axes))
        messages: list[Message] = [message]
        if state.has_rover_dialect:
            messages.insert(0, self._proofs.build(state, self._operator, now, message))
            self._proven_at = now
        if contact is self._fleet.selected and self._operator.record_demand(axes):
            self._changed, self._changed_at, self._changed_key = tuple(messages), now, self.key_read_at
        elif copying:
            messages = messages[:1]  # a vehicle of our dialect ignores MANUAL_CONTROL from a driver with a session
            self._changed += tuple(messages) if contact is self._fleet.selected else ()
        self._demands.replace(state.system, messages)

    def _queue_idle_proof(self, now: float) -> None:
        """Prove this session to the selected vehicle while it gets no demands, so that arming finds it proven."""
        contact = self._fleet.selected
        proven = now - self._proven_at < IDLE_PROOF_PERIOD - EARLY
        if contact is None or self._ending or not self._operator.live or proven:
            return
        state = contact.state
        if self.is_lent(state.system, now):
            return
        if state.has_rover_dialect and state.system not in self._demands:
            self._proven_at = now
            self._demands.replace(state.system, (self._proofs.build(state, self._operator, now),))
