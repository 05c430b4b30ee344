"""The ground station's core: intents and messages in, messages and snapshots for the screen out."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Sequence

from dialects import messages as m
from dialects.enums import Severity
from groundstation.input.style import Style
from groundstation.intents.driving import DriveKeyDown
from groundstation.intents.session import REST_PERIOD
from groundstation.intents.union import AnyIntent
from groundstation.snapshot import Snapshot
from groundstation.station.attention import Attention
from groundstation.station.charts.desk import ChartDesk
from groundstation.station.component import COMPONENT
from groundstation.station.doctor.doctor_desk import DoctorDesk
from groundstation.station.driving.commander import Commander
from groundstation.station.driving.departure import Departure
from groundstation.station.driving.driven import DrivenVehicle
from groundstation.station.driving.driving import DrivingController
from groundstation.station.driving.handover import Handover
from groundstation.station.driving.link_closing import LinkClosing
from groundstation.station.driving.operator import OperatorSession
from groundstation.station.heard_params import HeardParams
from groundstation.station.intent_handler import IntentHandler
from groundstation.station.links.heartbeat_sender import HeartbeatSender
from groundstation.station.links.id_conflict import IdConflict
from groundstation.station.links.link_stats import LinkStats
from groundstation.station.messages.message_detail import MessageDetail
from groundstation.station.messages.message_traffic import MessageTraffic
from groundstation.station.notes.operator_log import OperatorLog
from groundstation.station.notes.station_notes import StationNotes
from groundstation.station.readings import READINGS
from groundstation.station.relay.refusals import Refusals
from groundstation.station.relay.verb_relay import VerbRelay
from groundstation.station.services.service_desk import ServiceDesk
from groundstation.station.services.transfer_hold import TransferHold
from groundstation.station.services.vehicle_queries import VehicleQueries
from groundstation.station.surroundings import Surroundings
from groundstation.station.vehicle_builder import VehicleBuilder
from groundstation.station.view_feed import ViewFeed, ViewSource
from groundstation.station.views.drive_display import DriveDisplay
from groundstation.station.views.link_views import LinkViews
from groundstation.station.views.param_texts import ParamTexts
from groundstation.station.views.param_views import ParamViews
from groundstation.station.views.plan_views import PlanViews
from groundstation.vehicles.demand.drive_gate import drive_refusal
from groundstation.vehicles.demand.stop_commands import StopKind
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.readings.motor_outputs import is_turn
from groundstation.vehicles.state.message_log import MessageLog, VehicleText
from groundstation.views.doctor import DoctorRequest
from groundstation.views.links import Program
from groundstation.views.log import LogRequest
from link.core import LinkReport, Outgoing, Received
from link.protocol.link_events import LinkEvents
from link.services.timesync import TimesyncClient, handle_request

DEMANDS = (m.ManualControl, m.RoverOperatorPresence)

DECISIVE = (m.Heartbeat, m.ControlStatus, m.RoverControl, m.RoverDriveStatus)
"""Messages that report what decides on demands: armed, mode, who is in control, emergency stop."""

REST_AFTER = 1.0
"""s without anything under way after which the station rests: requests to many vehicles follow one another."""

TICK_PERIOD = 0.1
"""s between ticks that are enough for demands, which have times of their own (`due_at`)."""


class Station:
    """A core (link/core.py). `system` is our system id, `session` a random number."""

    def __init__(
        self,
        endpoints: Sequence[str],
        *,
        system: int = 255,
        style: Style = Style.HOLD,
        speed: float = 0.6,
        session: int = 0,
        texts: ParamTexts = ParamTexts(),  # noqa: B008 - frozen
        now: float = 0.0,
    ) -> None:
        self.log = MessageLog()
        self.operator = OperatorSession(style, speed, session)
        self.fleet = Fleet(self.log, system, COMPONENT)
        self._traffic = MessageTraffic(system, COMPONENT)
        self.surroundings = Surroundings(endpoints)
        self._system = system
        self._started = now
        self._commander = Commander(self.log, system, COMPONENT)
        self._links = LinkStats()
        hold = TransferHold(self.fleet, self.operator, self._links)
        self.services = ServiceDesk(
            self.fleet, self._commander, self.log, system, COMPONENT, texts=texts.cache, is_held=hold.is_held
        )
        self.driving = DrivingController(self.operator, self.fleet, self._commander, (system, COMPONENT))
        self.departure = Departure(self.fleet, self._commander, self.driving)
        self._handover = Handover(self.fleet, self._commander, self.driving, self.log, system)
        self._queries = VehicleQueries(self.fleet, self._commander, self._links, self.log, self.services)
        self.relay = VerbRelay(self.fleet, self.operator, self._commander, self.log)
        self._refusals = Refusals(self.fleet, self._commander, self.relay, self.log)
        self.params = HeardParams()
        self._timesync = TimesyncClient(system)
        self._doctor = DoctorDesk(
            self.fleet,
            self.services,
            self._queries,
            self._links,
            self.operator,
            (system, COMPONENT),
            lambda now: self.snapshot(now, now),
        )
        self._display = DriveDisplay(self.fleet, self.operator, self._timesync, system)
        self._vehicle = VehicleBuilder(self._commander, self.driving, self._handover, self._display)
        self._link_views = LinkViews(
            self.fleet,
            self._commander,
            self.driving,
            self._handover,
            self._queries,
            self._links,
            self._timesync,
            Program(system, COMPONENT, session),
        )
        self._detail = MessageDetail(self._traffic)
        self._charts = ChartDesk(self.fleet, self._traffic, self.operator, self._links, self._timesync)
        self.views = ViewFeed(
            {
                LogRequest: ViewSource(self.log.build_page, period=0.1),
                **self.services.sources,
                **self._link_views.sources,
                **PlanViews(self.fleet, self.services).sources,
                **ParamViews(self.fleet, self.services, texts.files).sources,
                **self._charts.sources,
                **self._detail.sources,
                **self._doctor.sources,
                **self._display.sources,
            }
        )
        self._attention = Attention(self.fleet, self.views, self._charts, self.relay)
        self.link_closing = LinkClosing(self.operator, self.fleet, self._links)
        self._intents = IntentHandler(
            self.operator,
            self.fleet,
            self._commander,
            self.driving,
            self.departure,
            self._handover,
            self.log,
            self.views,
            self.services,
            self._charts,
            self.link_closing,
        )
        self._operator_log = OperatorLog(self.log)
        self.notes = StationNotes(self.operator, self.fleet, self.driving)
        self.log.listener, self.log.name_of = self.notes.add_line, self.fleet.name_of
        self._heartbeat = HeartbeatSender(now)
        self._id_conflict = IdConflict(system)
        self._link_events = LinkEvents()
        self._outbox: list[Outgoing] = []
        self._active_at = now
        """When something was under way last."""
        self.rests = False
        """No vehicle is armed or was driven just now, and nothing is under way."""
        self.on_rest_end: Callable[[], None] = lambda: None
        """Called at once when `rests` becomes False."""

    # ---- Core ----

    def receive(self, received: Received, now: float) -> None:
        """Handle one message at once."""
        reading = type(received.message) in READINGS
        if not reading:
            self._receive_of_anybody(received, now)
        self.relay.receive(received, now)
        contact = self.fleet.get_or_add(received, now)
        if contact is not None and self._commander.blind_stop is not None:
            self._commander.stop_late(contact.state, now)
        autopilot = contact is not None and contact.state.component == received.component
        self._traffic.count(received.message, received.system, received.component, now, known=autopilot)
        if contact is None:
            return
        self._heartbeat.greet(received.peer, now)
        contact.state.receive(received, now)
        contact.details.receive(received, now)
        self._display.receive(contact, received, now)
        self._queries.receive(contact, received, now)
        self.services.receive(contact, received, now)
        if not reading:
            self._receive_exchange(contact, received, now)

    def stop_blindly(self, kind: StopKind, now: float) -> None:
        """Stop all vehicles, also those that are not heard."""
        self._commander.stop_blindly(now, kind)

    def _receive_of_anybody(self, received: Received, now: float) -> None:
        """Handle what other ground stations and components send as well as vehicles."""
        conflict = self._id_conflict.receive(received, now)
        if conflict is not None:
            self.log.add(now, "station", conflict, Severity.WARNING)
        self._link_views.stations.receive(received, now)
        self.params.receive(received)
        self._commander.receive_of_unheard(received)

    def _receive_exchange(self, contact: Contact, received: Received, now: float) -> None:
        """Handle what answers a request, makes one, or decides on something."""
        self._handover.receive(contact, received, now)
        self._doctor.receive(contact, received, now)
        if isinstance(received.message, DECISIVE):
            self.driving.handle_report(contact, now)
            if self.rests:  # it ends at once; its beginning is found by a tick, which looks at all vehicles
                self._update_rest(now)
        elif isinstance(received.message, m.StatusText):
            said = self.log.handle_statustext(received.message, received.system, now, received.component)
            self._handle_texts(said, now)
        if contact is self.fleet.selected:
            self._timesync.receive(received, now)
        self._outbox += handle_request(received, now, (self._system, COMPONENT))
        self._commander.receive(received, now)

    def tick(self, now: float) -> None:
        """Send what is due and handle what has timed out."""
        self._expire_lease(now)
        self._handle_texts(self.log.expire(now), now)
        self.fleet.update(now)
        self._display.tick(now)
        self._commander.tick(now)
        self._doctor.tick(now, watched=self.views.is_watching(DoctorRequest))
        self._handover.tick(now)
        self.relay.tick(now)
        if self.operator.live:
            self._queries.tick(now)
            self.services.tick(now)
        if self.operator.live and not self.driving.ending:
            self._timesync.tick(now)
            self._outbox += self._heartbeat.tick(now, driving=self.driving.drives_any)
        self.driving.update(now)
        self._log_driving(now)
        self.notes.tick(now)
        self.departure.tick(now)
        self._charts.tick(now)
        self._detail.tick(now)
        self._update_rest(now)
        self._doctor.examine_if_due(now)

    @property
    def looked_at(self) -> frozenset[int] | None:
        """System ids of the vehicles whose whole telemetry is needed; None: all."""
        return self._attention.systems

    @property
    def rest_period(self) -> float | None:
        """Time between ticks that are enough, s: nothing but demands is under way, and for them there is `due_at`."""
        if self._busy:
            return None
        return REST_PERIOD if self.rests else TICK_PERIOD

    @property
    def _busy(self) -> bool:
        """More than demands is under way."""
        return (
            self._commander.busy
            or self.services.busy
            or self.relay.busy
            or self._handover.busy
            or self._doctor.tester.busy
            or self.driving.ending
        )

    def _update_rest(self, now: float) -> None:
        driven = any(contact.state.armed or not contact.demand_stream.finished for contact in self.fleet)
        if self._busy or driven or self.driving.driven_vehicles(now) or self._heartbeat.is_greeting(now):
            self._active_at = now
        rests = now - self._active_at >= REST_AFTER
        if rests != self.rests:
            self.rests = rests
            self.operator.set_resting(rests, now)
            if not rests:
                self.on_rest_end()

    def decisive(self, now: float) -> Hashable:
        """Return what a driver must see at once if it changes: who drives what, armed, stopped, held keys, the log."""
        selected, operator = self.fleet.selected, self.operator
        state = selected.state if selected is not None else None
        vehicle = state and (state.system, state.armed, state.mode, state.driver, state.emergency_stop, state.failsafes)
        keys = (operator.sent_demand, operator.sticks.held_keys(now), operator.ignored(now))
        others = (self.fleet.also_armed, self._handover.busy, self.rests)
        return (self.driving.blocked_reason(now), self.log.state, vehicle, keys, others)

    @property
    def due_at(self) -> float | None:
        """When a demand is due, or one ends, before the next tick; None: none is."""
        return self.driving.due_at

    def act(self, now: float) -> None:
        """Send the demand that is due before the next tick."""
        self._expire_lease(now)
        before = self.operator.sent_demand
        self.driving.update(now)
        if self.operator.sent_demand != before:
            self._log_driving(now)
            self.notes.tick(now)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Update the link statistics; log when a link problem starts and ends."""
        self.notes.observe(reports, now)
        self.relay.observe(reports)
        reports = [*reports, *self.surroundings.not_open]
        selected = self.fleet.selected
        self._links.update(reports, selected.state.system if selected else None, now)
        self.fleet.observe(reports, now)
        self.driving.adapt(self._links)
        self._traffic.observe(reports, now)
        self._traffic.set_labels({(each.state.system, each.state.component): each.state.name for each in self.fleet})
        for report in reports:
            event = self._link_events.update(report)
            if event:
                self.log.add(now, "station", f"{report.name}: {event.text}", event.severity)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now and clear the queue."""
        outbox, self._outbox = self._outbox, []
        demands = self.driving.messages_to_send()
        commands = self._commander.messages_to_send() + self._queries.messages_to_send()
        services = self.services.messages_to_send()  # repeated later if they are dropped here
        return (
            demands
            + self.relay.messages_to_send()
            + commands
            + self._doctor.messages_to_send()
            + self._timesync.messages_to_send()
            + outbox
            + (services if self.operator.live else [])
        )

    def handle_sent(self, message: m.Message, sequence: int, now: float) -> None:
        """Record that a message was sent under this packet sequence number."""
        self._traffic.count_sent(message, now)
        self._display.handle_sent(message, now)
        self.driving.handle_sent(message, sequence, now)

    def handle_refused(self, message: m.Message, why: str, now: float) -> None:
        """Tell who wanted a message that our role does not allow."""
        self._refusals.handle(message, why, now)

    def may_send(self, message: m.Message, now: float) -> bool:
        """Return False for what would move a vehicle: its kind is not driven, or our process stood still."""
        why = drive_refusal(message, (contact.state for contact in self.fleet))
        if why is not None:
            self._refusals.handle(message, why, now)
            return False
        moves = isinstance(message, DEMANDS) or is_turn(message)
        return not moves or not self.operator.stall.is_stalled(now)

    def report_to_watchdog(self, now: float) -> tuple[DrivenVehicle, ...]:
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
        self._charts.mark_key(push, now)
        return True

    def handle_intent(self, intent: AnyIntent, now: float, *, read_at: float | None = None) -> None:
        """Carry out what the operator wants, and queue its messages. `read_at`: when the screen read the key."""
        self._expire_lease(now)
        self._charts.mark_key(intent, now)
        self._operator_log.handle(intent, now)
        self._doctor.handle(intent, now)
        if intent.is_input:
            self.driving.key_read_at = now if read_at is None else read_at
        self._intents.handle(intent, now)
        self.driving.key_read_at = None
        self._log_driving(now)
        self.notes.handle(intent, now)
        self._update_rest(now)

    @property
    def finished(self) -> bool:
        """Quit was requested, the last neutral demand is out, and nothing is left to disarm."""
        return (
            self.driving.ending
            and self.driving.finished
            and self.departure.finished
            and self._handover.finished
            and self.relay.finished
        )

    def snapshot(self, now: float, wall: float) -> Snapshot:
        """Build the snapshot for the screen; `now` and `wall` are the same moment on both clocks.

        It has no effect. Whoever sends it counts it (`Snapshot.number`).
        """
        selected = self.fleet.selected
        return Snapshot(
            uptime=now - self._started,
            endpoints=self.surroundings.endpoints,
            addresses=() if selected else self.surroundings.addresses,
            waiting=None if selected else self.surroundings.waiting(has_traffic=self._links.has_traffic),
            vehicle=self._vehicle.build(selected, now) if selected else None,
            left_armed=self.departure.left_armed(now),
            id_conflict=self._id_conflict.text(now),
            blind_stop=self._commander.describe_blind_stop(),
            vehicles=self.fleet.system_ids,
            not_shown=self.fleet.not_shown,
            also_armed=self.fleet.also_armed,
            handover=self._handover.notice(now),
            operator=self.operator.build_view(
                self.driving.blocked_reason(now), bool(selected and selected.demand_stream.streaming), now
            ),
            links=self._links.build_views(self._timesync.round_trip),
            signing=self.fleet.signing_of(selected, now),
            texts=self.log.build_lines(now, wall),
            faults=self._doctor.faults,
            recording=self.surroundings.recording,
            simulator=self.surroundings.simulator,
            transfers=self.services.progress,
            rests=self.rests,
        )

    def _expire_lease(self, now: float) -> None:
        """Go neutral when the lease has run out: before any intent, because after a freeze intents may come first.

        Without an armed vehicle of ours it is not reported: a slow start would be.
        """
        lapse = self.operator.expire_lease(now)
        if lapse is None:
            return
        self.driving.drop_demands()
        if any(contact.ours and contact.state.armed for contact in self.fleet):
            self.log.add(now, "station", f"{lapse}: neutral, release the keys", Severity.CRITICAL)

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
            self._doctor.handle_text(contact, each.text, now)
