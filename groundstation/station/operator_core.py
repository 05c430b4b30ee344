"""OperatorCore: one operator, the vehicles, and what goes to and comes from them. No screen is needed, and no I/O."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

from dialects import messages as m
from dialects.enums import Severity
from groundstation.intents.session import REST_PERIOD
from groundstation.station.core_listener import CoreListener
from groundstation.station.core_parts import CoreParts
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.station.readings import READINGS
from groundstation.vehicles.demand import drive_gate, flight_gate
from groundstation.vehicles.demand.stop_commands import StopKind
from groundstation.vehicles.fleet import Contact
from groundstation.vehicles.readings.motor_outputs import is_turn
from groundstation.vehicles.state.message_log import VehicleText
from link.core import LinkReport, Outgoing, Received
from link.services.timesync import handle_request

if TYPE_CHECKING:
    from groundstation.intents.driving import DriveByPicture, DriveKeyDown
    from groundstation.intents.union import AnyIntent
    from groundstation.station.intent_handler import IntentHandler

DEMANDS = (m.ManualControl, m.RoverOperatorPresence)

DECISIVE = (m.Heartbeat, m.ControlStatus, m.RoverControl, m.RoverDriveStatus)
"""Messages that report what decides on demands: armed, mode, who is in control, emergency stop."""

CHECKED = drive_gate.CHECKED | flight_gate.CHECKED
"""Kinds of messages that may be refused at the last look."""

REST_AFTER = 1.0
"""s without anything under way after which the station rests: requests to many vehicles follow one another."""

TICK_PERIOD = 0.1
"""s between ticks that are enough for demands, which have times of their own (`due_at`)."""


class _Worker(Protocol):
    """A part of which something may be under way that needs all ticks."""

    @property
    def busy(self) -> bool: ...


class OperatorCore:
    """A core (link/core.py). Its parts do the work; here is which of them gets what, and in which order."""

    def __init__(self, parts: CoreParts, listener: CoreListener | None = None) -> None:
        """Join the parts. `listener` shows and records what happens; None: nobody does."""
        self.parts = parts
        self.log, self.operator, self.fleet = parts.log, parts.operator, parts.fleet
        self.services, self.driving, self.verbs = parts.services, parts.driving, parts.verbs
        self.shutdown, self.link_closing, self.proposals = parts.shutdown, parts.link_closing, parts.proposals
        self.station_info, self.params = parts.links.station_info, parts.links.params
        self._listener = listener or CoreListener()
        self._commander, self._handover, self._queries = parts.commander, parts.handover, parts.queries
        self._links, self._timesync, self._heartbeat = parts.links, parts.links.timesync, parts.links.heartbeat
        self._paths = parts.paths
        self._refusals, self._operator_log = parts.refusals, parts.operator_log
        self._outbox = parts.outbox
        self._workers: tuple[_Worker, ...] = (
            parts.commander, parts.services, parts.handover, parts.proposals, self._listener
        )  # fmt: skip
        self._active_at = parts.started
        """When something was under way last."""
        self._tick_due = parts.started
        """When everything is to tick again while only verbs need all ticks."""
        self._now = parts.started
        """Time of the newest event."""
        self.repeats = False
        """The newest message has only repeated what another path had brought, so that nothing is to be sent."""
        self.on_rest_end: Callable[[], None] = lambda: None
        """Called at once when `rests` becomes False."""

    @cached_property
    def intents(self) -> IntentHandler:
        """Who carries out which intent; a verb of its own process has none, and does not import them."""
        from groundstation.station.intent_handler import IntentHandler

        return IntentHandler(self.parts)

    # ---- Core ----

    def receive(self, received: Received, now: float) -> None:
        """Handle one message at once. What a second path to a vehicle repeats is only counted."""
        self._now, self.repeats = now, False
        reading = type(received.message) in READINGS
        if not reading:
            self._links.receive(received, now)
            self._commander.blind_stops.receive(received)
        contact = self.fleet.get_or_add(received, now)
        if contact is not None:
            if self._commander.blind_stops:
                self._commander.stop_late(contact.state, now)
            self._heartbeat.greet(received.peer, now)
            if not contact.state.receive(received, now):
                self.repeats = not (self._commander.blind_stops or self._heartbeat.is_greeting(now))
                return
        self._listener.hear(received, contact, now)
        if contact is not None:
            self._receive_known(contact, received, now, reading=reading)
        self.verbs.receive(received, now)  # last: a verb that runs here sees what the others have made of it

    def _receive_known(self, contact: Contact, received: Received, now: float, *, reading: bool) -> None:
        """Handle a message of a vehicle, or of another component of its system."""
        contact.details.receive(received, now)
        self._listener.receive(contact, received, now)
        self._queries.receive(contact, received, now)
        self.services.receive(contact, received, now)
        if not reading:
            self._receive_exchange(contact, received, now)

    def stop_blindly(self, kind: StopKind, system: int, now: float) -> None:
        """Stop a vehicle that is not heard; 0: all vehicles."""
        self._commander.stop_blindly(now, kind, system)

    def stop(self, kind: StopKind, contact: Contact, now: float) -> None:
        """Stop a vehicle, which need not be the selected one."""
        self._commander.stop(contact.state, kind, now)

    def claim(self, contact: Contact, now: float) -> None:
        """Note that a vehicle has accepted arming from a verb: without CONTROL_STATUS that is control."""
        self._commander.claim(contact.state, now)

    def find_dialect(self, contact: Contact, now: float) -> None:
        """Ask a vehicle for its dialect, if that is due; its `dialect_probe` has the answer."""
        self._queries.find_dialect(contact, now)

    def _receive_exchange(self, contact: Contact, received: Received, now: float) -> None:
        """Handle what answers a request, makes one, or decides on something."""
        self._handover.receive(contact, received, now)
        self._listener.receive_exchange(contact, received, now)
        if isinstance(received.message, DECISIVE):
            self.driving.handle_report(contact, now)
            if self.rests:  # it ends at once; its beginning is found by a tick, which looks at all vehicles
                self._update_rest(now)
        elif isinstance(received.message, m.StatusText):
            said = self.log.handle_statustext(received.message, received.system, now, received.component)
            self._handle_texts(said, now)
        if contact is self.fleet.selected:
            self._timesync.receive(received, now)
        self._outbox.commands += handle_request(received, now, self.parts.ids)
        self._commander.receive(received, now)

    def tick(self, now: float) -> None:
        """Send what is due and handle what has timed out; often only for verbs, as nothing else needs all ticks."""
        self._now = now
        if self.verbs.busy and now < self._tick_due and not self._works:
            self.verbs.tick(now)
            return
        self._tick_due = now + TICK_PERIOD
        self._expire_lease(now)
        if self.proposals.busy:
            self.proposals.tick(now)
        self._handle_texts(self.log.expire(now), now)
        self.fleet.update(now)
        self._commander.tick(now)
        self._listener.tick(now)
        self._handover.tick(now)
        self.verbs.tick(now)
        if self.operator.live:
            self._queries.tick(now)
        if self._uses_services:
            self.services.tick(now)
        permission = self.driving.judge(now)
        if self.operator.live and not self.driving.ending:
            self._timesync.tick(now)
            self._outbox.commands += self._timesync.messages_to_send()
            self._outbox.commands += self._heartbeat.tick(now, driving=bool(permission.controlled))
        self.driving.update(permission, now)
        self._log_driving(now)
        self._listener.follow(None, permission, now)
        self.shutdown.tick(now)
        self._update_rest(now)
        self._listener.end_tick(now)

    @property
    def interesting_systems(self) -> frozenset[int] | None:
        """System ids of the vehicles whose whole telemetry is needed: shown, driven, or asked for something.

        A link of a fleet asks the others for less (link/fleet/brevity.py): a table of a hundred vehicles needs neither
        their attitude nor ten positions a second. None: all, while a verb is connected, which gets what all send.
        """
        if self.verbs.busy:
            return None
        return self._listener.systems.union(each.state.system for each in self.fleet if self._is_needed(each))

    def _is_needed(self, contact: Contact) -> bool:
        return contact is self.fleet.selected or contact.ours or not contact.demand_stream.finished or contact.busy

    @property
    def rests(self) -> bool:
        """No vehicle is armed or was driven just now, and nothing is under way."""
        return self.operator.rests

    @property
    def rest_period(self) -> float | None:
        """Time between ticks that are enough, s: nothing but demands is under way, and for them there is `due_at`."""
        if self._busy:
            return None
        return REST_PERIOD if self.rests else TICK_PERIOD

    @property
    def _busy(self) -> bool:
        """More than demands is under way."""
        return self.verbs.busy or self._works

    @property
    def _works(self) -> bool:
        """The same of all but verbs."""
        return self.driving.ending or any(each.busy for each in self._workers)

    def _update_rest(self, now: float) -> None:
        driven = any(contact.state.armed or not contact.demand_stream.finished for contact in self.fleet)
        if driven or self._busy or self.driving.driven_vehicles(now) or self._heartbeat.is_greeting(now):
            self._active_at = now
        rests = now - self._active_at >= REST_AFTER
        if rests != self.rests:
            self.operator.set_resting(rests, now)
            if not rests:
                self.on_rest_end()

    def urgent_state(self, now: float) -> Hashable:
        """Return what a driver must see at once if it changes: who drives what, armed, stopped, held keys, the log."""
        selected, operator = self.fleet.selected, self.operator
        state = selected.state if selected is not None else None
        vehicle = state and (state.system, state.armed, state.mode, state.driver, state.emergency_stop, state.failsafes)
        keys = (operator.sent_demand, operator.sticks.held_keys(now), operator.ignored(now))
        others = (self.fleet.also_armed, self._handover.busy, self.rests)
        return (self.driving.judge(now).reason, self.log.state, vehicle, keys, others)

    @property
    def due_at(self) -> float | None:
        """When a demand is due, or one ends, before the next tick; None: none is."""
        return self.driving.due_at

    def act(self, now: float) -> None:
        """Send the demand that is due before the next tick."""
        self._now = now
        self._expire_lease(now)
        before = self.operator.sent_demand
        permission = self.driving.judge(now)
        self.driving.update(permission, now)
        if self.operator.sent_demand != before:
            self._log_driving(now)
            self._listener.follow(None, permission, now)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Update the link statistics; log when a link problem starts and ends."""
        self._listener.observe(reports, now)
        self.verbs.observe(reports, now)
        reports = [*reports, *self.station_info.not_open]
        selected = self.fleet.selected
        self._links.stats.update(reports, selected.state.system if selected else None, now)
        self.fleet.observe(reports, now)
        self._links.measure_paths(self.fleet, now)
        self.driving.adapt(self._links.stats)
        self._links.log_events(reports, now)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now and clear the queue."""
        if not self._uses_services:
            self._outbox.services.clear()  # repeated later
        return [self._paths.route(each, self._now) for each in self._outbox.pop()]

    @property
    def _uses_services(self) -> bool:
        """Whether somebody is there for whom requests are repeated: a screen, or a verb that runs here."""
        return self.operator.live or self.verbs.uses_services

    def handle_sent(self, message: m.Message, sequence: int, now: float) -> None:
        """Record that a message was sent under this packet sequence number."""
        self._listener.handle_sent(message, now)
        self.driving.handle_sent(message, sequence, now)

    def handle_refused(self, message: m.Message, why: str, now: float) -> None:
        """Report a message that our signing role forbids to the part that queued it."""
        self._refusals.handle(message, why, now)

    def may_send(self, message: m.Message, now: float) -> bool:
        """Return False for what would move a vehicle: its kind is not driven, or our process stood still."""
        why = self._find_refusal(message) if type(message) in CHECKED else None
        if why is not None:
            self._refusals.handle(message, why, now)
            return False
        moves = isinstance(message, DEMANDS) or is_turn(message)
        return not moves or not self.operator.stall.is_stalled(now)

    def _find_refusal(self, message: m.Message) -> str | None:
        """Return why a message may not be sent to one of the vehicles that it is for."""
        fleet = self.fleet
        meant = fleet.addressed(message)
        if why := drive_gate.drive_refusal(message, meant):
            return why
        for state in meant:
            if state.model.flies:
                unsafe, fence = fleet.take_off_refusal(state.system), fleet.altitude_fence(state.system)
                if why := flight_gate.flight_refusal(message, state, unsafe, fence):
                    return why
        return None

    def report_to_watchdog(self, now: float) -> tuple[WatchdogTarget, ...]:
        """Return the vehicles that the watchdog stops if no further call follows in time (stall.py)."""
        self._expire_lease(now)
        self._update_rest(now)
        self.operator.stall.record_report(now, rests=self.rests)
        return self.driving.driven_vehicles(now)

    def renew_lease(self, now: float) -> bool:
        """Extend the lease of a screen that renews it in time, which changes nothing else.

        Returns False, without a renewal, if the lease had run out: then RenewLease is an intent like any other.
        """
        self._expire_lease(now)
        if self.operator.live:
            self.operator.renew_lease(now)
        return self.operator.live

    def prolong_key(self, push: DriveKeyDown, now: float) -> bool:
        """Handle a repeat of a drive key that is held, which changes nothing but until when it counts.

        Returns False if it is something else: then it is an intent like any other.
        """
        self._expire_lease(now)
        if not self.operator.prolong(push, now):
            return False
        self._listener.repeat_key(push, now)
        return True

    def prolong_picture(self, intent: DriveByPicture, now: float) -> bool:
        """Handle a newer picture of a driver whose keys drive by pictures, ten times a second.

        Returns False if it changes more than until when they do: then it is an intent like any other.
        """
        self._expire_lease(now)
        return self.operator.live and self.operator.prolong_picture(intent, now)

    def handle_intent(self, intent: AnyIntent, now: float, *, read_at: float | None = None) -> None:
        """Carry out what the operator wants, and queue its messages. `read_at`: when the screen read the key."""
        self._now = now
        self._expire_lease(now)
        permission = self.driving.judge(now)
        self._operator_log.handle(intent, now)
        self._listener.begin_intent(intent, permission, now)
        if intent.is_input:
            self.driving.key_read_at = now if read_at is None else read_at
        permission = self.intents.handle(intent, permission, now)
        self.driving.key_read_at = None
        self._log_driving(now)
        self._listener.follow(intent, permission, now)
        self._update_rest(now)
        self.intents.finish(intent, now)

    @property
    def finished(self) -> bool:
        """Quit was requested, the last neutral demand is out, and nothing is left to disarm."""
        return (
            self.driving.ending
            and self.driving.finished
            and self.shutdown.finished
            and self._handover.finished
            and not self.verbs.busy
        )

    def _expire_lease(self, now: float) -> None:
        """Go neutral when the lease has run out: before any intent, because after a freeze intents may come first.

        It is reported if keys could have driven a vehicle of ours: a slow start, a screen that is left and a vehicle
        that drives itself need no warning.
        """
        lapse = self.operator.expire_lease(now)
        if lapse is None:
            return
        self.driving.drop_demands()
        states = [contact.state for contact in self.fleet if contact.ours]
        if lapse.left or self.driving.ending or not any(each.armed and not each.drives_itself for each in states):
            return
        if lapse.drove:
            self.log.add(now, "station", f"{lapse.text}: neutral, release the keys", Severity.CRITICAL)
        else:
            self.log.add(now, "station", f"{lapse.text}: no key was down", Severity.INFO)

    def _log_driving(self, now: float) -> None:
        selected = self.fleet.selected
        self._operator_log.tick(self.operator.sent_demand, selected.state.latency if selected else None, now)

    def _handle_texts(self, texts: Iterable[VehicleText], now: float) -> None:
        for each in texts:
            contact = self.fleet.get(each.system)
            if contact is None:
                continue
            contact.state.handle_text(each.text)
            self.fleet.signing.handle_text(each.system, each.text)
            self._commander.handle_statustext(each.system, each.text, each.severity, now)
            self.services.handle_text(contact, each.text, each.severity, now)
            self._listener.handle_text(contact, each.text, now)
