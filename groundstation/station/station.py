"""The ground station's core: intents and messages in, messages and snapshots for the screen out."""

from __future__ import annotations

from collections.abc import Sequence

from dialects import messages as m
from dialects.enums import Severity
from groundstation.input.style import Style
from groundstation.intents import AnyIntent
from groundstation.snapshot import Snapshot, VehicleView
from groundstation.station.commander import Commander
from groundstation.station.departure import Departure
from groundstation.station.driving import DrivingController
from groundstation.station.heartbeat_sender import HeartbeatSender
from groundstation.station.id_conflict import IdConflict
from groundstation.station.intent_handler import IntentHandler
from groundstation.station.link_stats import LinkStats
from groundstation.station.message_rates import MessageRates
from groundstation.station.operator import OperatorSession
from groundstation.station.service_desk import ServiceDesk
from groundstation.station.vehicle_queries import VehicleQueries
from groundstation.station.view_feed import ViewFeed, ViewSource
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.message_log import MessageLog
from groundstation.views import LogRequest, ParamPageRequest
from link.core import LinkReport, Outgoing, Received
from link.protocol.link_events import LinkEvents
from link.services.timesync import TimesyncClient, handle_request

COMPONENT = 190
"""MAV_COMP_ID_MISSIONPLANNER: the component id that ground stations use."""


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
        now: float = 0.0,
    ) -> None:
        self.log = MessageLog()
        self.operator = OperatorSession(style, speed, session)
        self.fleet = Fleet(self.log, system, COMPONENT)
        self._endpoints = tuple(endpoints)
        self._system = system
        self._started = now
        self._commander = Commander(self.log, system, COMPONENT)
        self._services = ServiceDesk(self.fleet, self._commander, self.log, system, COMPONENT)
        self.views = ViewFeed(
            {
                LogRequest: ViewSource(self.log.build_page, period=0.1),
                ParamPageRequest: ViewSource(self._services.build_param_page, period=0.25),
            }
        )
        """Request -> its source."""
        self._driving = DrivingController(self.operator, self.fleet, self._commander, system)
        self._departure = Departure(self.fleet, self._commander, self._driving)
        self._intents = IntentHandler(
            self.operator,
            self.fleet,
            self._commander,
            self._driving,
            self._departure,
            self.log,
            self.views,
            self._services,
        )
        self._links = LinkStats()
        self._queries = VehicleQueries(self.fleet, self._commander, self._links, self.log, self._services)
        self._timesync = TimesyncClient(system)
        self._heartbeat = HeartbeatSender(now)
        self._id_conflict = IdConflict(system)
        self._link_events = LinkEvents()
        self._message_rates = MessageRates()
        self._simulator_state: str | None = None
        self._outbox: list[Outgoing] = []
        self._snapshot_count = 0

    # ---- Core ----

    def receive(self, received: Received, now: float) -> None:
        """Handle one message at once."""
        self._message_rates.count(received.message, now)
        conflict = self._id_conflict.receive(received, now)
        if conflict is not None:
            self.log.add(now, "station", conflict, Severity.WARNING)
        contact = self.fleet.get_or_add(received, now)
        if contact is None:
            return
        self._heartbeat.greet(received.peer, now)
        contact.state.receive(received, now)
        self._queries.receive(contact, received, now)
        self._services.receive(contact, received, now)
        match received.message:
            case m.StatusText() as message:
                self._handle_statustext(message, contact, now)
            case m.RoverDriveStatus() as message if message.source_system == self._system:
                contact.state.latency.record_applied(message.source_seq, now, message.demand_age_ms / 1000)
        if contact is self.fleet.selected:
            self._timesync.receive(received, now)
        self._outbox += handle_request(received, now, (self._system, COMPONENT))
        self._commander.receive(received, now)

    def tick(self, now: float) -> None:
        """Send what is due and handle what has timed out."""
        self._expire_lease(now)
        self.log.expire(now)
        self.fleet.update(now)
        self._commander.tick(now)
        if self.operator.live:
            self._queries.tick(now)
            self._services.tick(now)
        if self.operator.live and not self._driving.ending:
            self._timesync.tick(now)
            self._outbox += self._heartbeat.tick(now)
        self._driving.update(now)
        self._departure.tick(now)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Update the link statistics; log when a link problem starts and ends."""
        selected = self.fleet.selected
        self._links.update(reports, selected.state.system if selected else None, now)
        for report in reports:
            event = self._link_events.update(report)
            if event:
                self.log.add(now, "station", f"{report.name}: {event.text}", event.severity)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now and clear the queue."""
        outbox, self._outbox = self._outbox, []
        demands = self._driving.messages_to_send()
        commands = self._commander.messages_to_send() + self._queries.messages_to_send()
        services = self._services.messages_to_send()  # repeated later if they are dropped here
        return (
            demands + commands + self._timesync.messages_to_send() + outbox + (services if self.operator.live else [])
        )

    def handle_sent(self, message: m.Message, sequence: int, now: float) -> None:
        """Record that a message was sent under this packet sequence number."""
        self._message_rates.count(message, now, sent=True)
        self._driving.handle_sent(message, sequence, now)

    # ---- the shell around the core ----

    def handle_intent(self, intent: AnyIntent, now: float) -> None:
        """Carry out what the operator wants; the resulting messages are ready to be sent."""
        self._expire_lease(now)
        self._intents.handle(intent, now)

    def set_simulator_state(self, state: str | None) -> None:
        """Record the state of the simulator, for the next snapshot."""
        self._simulator_state = state

    @property
    def finished(self) -> bool:
        """Quit was requested, the last neutral demand is out, and nothing is left to disarm."""
        return self._driving.ending and self._driving.finished and self._departure.finished

    def snapshot(self, now: float, wall: float) -> Snapshot:
        """Build the snapshot for the screen; `now` and `wall` are the same moment on both clocks."""
        self._snapshot_count += 1
        selected = self.fleet.selected
        return Snapshot(
            number=self._snapshot_count,
            uptime=now - self._started,
            endpoints=self._endpoints,
            waiting=self._waiting(),
            vehicle=self._vehicle_view(selected, now) if selected else None,
            left_armed=self._departure.left_armed(now),
            id_conflict=self._id_conflict.text(now),
            also_armed=self.fleet.also_armed,
            operator=self.operator.build_view(
                self._driving.blocked_reason(now), bool(selected and selected.demand_stream.streaming), now
            ),
            links=self._links.build_views(self._timesync.round_trip),
            texts=self.log.build_lines(now, wall),
            messages=self._message_rates.build_rates(now),
            simulator=self._simulator_state,
        )

    def _expire_lease(self, now: float) -> None:
        """Go neutral when the lease has run out: before any intent, because after a freeze intents may come first."""
        if self.operator.expire_lease(now):
            self.log.add(now, "station", "screen not responding: neutral, control released", Severity.CRITICAL)

    def _handle_statustext(self, message: m.StatusText, contact: Contact, now: float) -> None:
        text = self.log.handle_statustext(message, contact.state.system, now)
        if text is not None:
            self._commander.handle_statustext(contact.state.system, text, message.severity, now)
            self._services.handle_text(contact, text, message.severity, now)

    def _vehicle_view(self, contact: Contact, now: float) -> VehicleView:
        state, commander = contact.state, self._commander
        return state.build_view(
            now,
            in_control=self._driving.is_in_control(contact),
            emergency_stop=state.emergency_stop or commander.is_locked(state.system),
            emergency_progress=None if state.emergency_stop else commander.emergency_progress(state.system, now),
            without_link=contact.without_link,
            refusal=commander.last_refusal(state.system),
            obeys=contact.settings_check.obeys if contact.settings_check else None,
            warnings=contact.settings_check.warnings if contact.settings_check else (),
        )

    def _waiting(self) -> str | None:
        if self.fleet.selected is not None:
            return None
        where = ", ".join(self._endpoints)
        if self._links.has_traffic:
            return f"receiving data on {where}, but no vehicle heartbeat yet"
        return f"waiting for a vehicle on {where}"
