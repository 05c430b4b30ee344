"""The station: the operator's intents and the vehicles' messages in, messages and a picture for the screen out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from dialects import messages as m
from dialects.enums import Autopilot, Severity, SystemState, VehicleType
from dialects.modes import Mode
from groundstation import intents as i
from groundstation.input.style import Style
from groundstation.snapshot import Snapshot, VehicleView
from groundstation.station.commander import Commander
from groundstation.station.driving import DrivingController, is_autonomous
from groundstation.station.link_stats import LinkStats
from groundstation.station.message_rates import MessageRates
from groundstation.station.operator import OperatorSession
from groundstation.station.vehicle_queries import VehicleQueries
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.message_log import MessageLog
from groundstation.vehicles.vehicle_state import VehicleState
from link.core import LinkReport, Outgoing, Peer, Received
from link.protocol.link_events import LinkEvents
from link.services.timesync import TimesyncClient, handle_request

COMPONENT = 190
"""MAV_COMP_ID_MISSIONPLANNER: the component id that ground stations use."""

HEARTBEAT_PERIOD = 1.0
"""s (MAVLink heartbeat protocol)."""

GREETING, GREETING_PERIOD = 1.0, 0.2
"""s for which, and s between which, a vehicle at a new address is sent heartbeats: all are lost once in 400 at 30 %."""

GREETED_KEPT = 64
"""Addresses of vehicles remembered; each restart of one brings another."""


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
        self.simulator_state: str | None = None
        """State of the simulator, told by the shell that runs it."""
        self.log = MessageLog()
        self.operator = OperatorSession(style, speed, session)
        self._endpoints = tuple(endpoints)
        self._system = system
        self._started = now
        self._fleet = Fleet(self.log, system)
        self._commander = Commander(self.log, system, COMPONENT)
        self._driving = DrivingController(self.operator, self._fleet, self._commander, system)
        self._links = LinkStats()
        self._inquiry = VehicleQueries(self._fleet, self._commander, self._links, self.log)
        self._timesync = TimesyncClient(system)
        self._heartbeat_due = 0.0
        self._greeted: set[Peer] = set()
        self._greet_until = now
        self._troubles = LinkEvents()
        self._outbox: list[Outgoing] = []
        self._traffic = MessageRates()
        self._number = 0

    # ---- Core ----

    def receive(self, received: Received, now: float) -> None:
        """Take one message and act on it at once."""
        self._traffic.count(received.message, now)
        contact = self._fleet.get_or_add(received, now)
        if contact is None:
            return
        self._greet(received.peer, now)
        contact.state.receive(received, now)
        self._inquiry.handle_message(contact, received.message, now)
        match received.message:
            case m.StatusText() as message:
                self._handle_statustext(message, received.system, now)
            case m.RoverDriveStatus() as message if message.source_system == self._system:
                contact.state.latency.record_applied(message.source_seq, now, message.demand_age_ms / 1000)
        if contact is self._fleet.selected:
            self._timesync.receive(received, now)
        self._outbox += handle_request(received, now, (self._system, COMPONENT))
        self._commander.receive(received, now)

    def tick(self, now: float) -> None:
        """Send what is due, act on what is overdue."""
        if self.operator.expire_lease(now):
            self.log.add(now, "station", "the screen does not answer: neutral, control given up", Severity.CRITICAL)
        self.log.expire(now)
        self._fleet.update(now)
        self._commander.tick(now)
        if self.operator.live:
            self._inquiry.tick(now)
        if self.operator.live and not self._driving.ending:
            self._live(now)
        self._driving.update(now)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Take what the links say of themselves; of a problem the beginning and the end are told."""
        selected = self._fleet.selected
        self._links.update(reports, selected.state.system if selected else None, now)
        for report in reports:
            news = self._troubles.update(report)
            if news:
                self.log.add(now, "station", f"{report.name}: {news.text}", news.severity)

    def messages_to_send(self) -> list[Outgoing]:
        """What to send now; empties what it returns."""
        outbox, self._outbox = self._outbox, []
        demands = self._driving.messages_to_send()
        orders = self._commander.messages_to_send() + self._inquiry.messages_to_send()
        return demands + orders + self._timesync.messages_to_send() + outbox

    def handle_sent(self, message: m.Message, sequence: int, now: float) -> None:
        """A message went out under this packet sequence."""
        self._traffic.count(message, now, sent=True)
        self._driving.sent(message, sequence, now)

    # ---- the operator ----

    def handle_intent(self, intent: i.AnyIntent, now: float) -> None:
        """Take what the operator wants; what follows from it is ready to be sent."""
        if not isinstance(intent, (i.RenewLease, i.SetKeyGate, i.ReportKeyReleases, i.Quit)):
            self.operator.record_input(now)
        self._driving.update_permission(now)
        method = _INTENTS.get(type(intent))
        if method is not None:
            method(self, intent, now)
        self._driving.update(now)

    @property
    def finished(self) -> bool:
        """Quit was asked and the last neutral frame is out."""
        return self._driving.ending and self._driving.finished

    def snapshot(self, now: float, wall: float) -> Snapshot:
        """The picture for the screen; `now` and `wall` are the same moment on both clocks."""
        self._number += 1
        selected = self._fleet.selected
        return Snapshot(
            number=self._number,
            uptime=now - self._started,
            endpoints=self._endpoints,
            waiting=self._waiting(),
            vehicle=self._vehicle_view(selected, now) if selected else None,
            vehicles=self._fleet.system_ids,
            operator=self.operator.build_view(
                self._driving.blocked_reason(now), bool(selected and selected.demand_stream.streaming), now
            ),
            links=self._links.build_views(self._timesync.round_trip),
            texts=self.log.build_lines(now, wall),
            messages=self._traffic.build_rates(now),
            simulator=self.simulator_state,
        )

    # ---- intents ----

    def _push(self, intent: i.DriveKeyDown, now: float) -> None:
        self.operator.press(intent, now)

    def _release(self, intent: i.DriveKeyUp, now: float) -> None:
        self.operator.sticks.release(intent.key)

    def _stop(self, intent: i.Stop, now: float) -> None:
        self.operator.sticks.stop()
        selected = self._fleet.selected
        if intent.reason == i.STOP_KEY and selected is not None and is_autonomous(selected.state):
            self._commander.set_mode(selected.state, Mode.HOLD.name, now)  # neutral sticks stop no mission

    def _change_speed(self, intent: i.ScaleLimits, now: float) -> None:
        self.operator.sticks.scale_limits(intent)

    def _set_style(self, intent: i.SetStyle, now: float) -> None:
        if self.operator.sticks.set_style(intent.style):
            self.log.add(now, "station", f"drive style {self.operator.sticks.style}", Severity.NOTICE)

    def _exact(self, intent: i.ReportKeyReleases, now: float) -> None:
        self.operator.sticks.set_reports_releases()

    def _gate(self, intent: i.SetKeyGate, now: float) -> None:
        self.operator.set_gate(intent, now)

    def _lease(self, intent: i.RenewLease, now: float) -> None:
        self.operator.renew_lease(now)

    def _select(self, intent: i.SelectVehicle | i.SelectNextVehicle, now: float) -> None:
        self.operator.reset_demand(now)
        if isinstance(intent, i.SelectVehicle):
            self._fleet.select(intent.system, now)
        else:
            self._fleet.select_next(now)

    def _quit(self, intent: i.Quit, now: float) -> None:
        self.operator.sticks.block(now)
        self._driving.ending = True

    def _order(self, intent: i.AnyIntent, now: float) -> None:
        """Intents that are orders to the selected vehicle."""
        selected = self._fleet.selected
        if selected is None:
            self.log.add(now, "station", "there is no vehicle yet", Severity.WARNING)
            return
        if not isinstance(intent, (i.SetMode, i.RequestControl)):
            self.operator.sticks.block(now)  # arming must not begin with a key held, and the others are stops
        _ORDERS[type(intent)](self._commander, selected.state, intent, now)

    # ---- vehicles ----

    def _live(self, now: float) -> None:
        """What only a live operator's station says: it is here."""
        self._timesync.tick(now)
        if now >= self._heartbeat_due:
            greeting = now < self._greet_until
            self._heartbeat_due = now + (GREETING_PERIOD if greeting else HEARTBEAT_PERIOD)
            heartbeat = m.Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, SystemState.ACTIVE, 3)
            self._outbox.append(Outgoing(heartbeat))

    def _greet(self, peer: Peer, now: float) -> None:
        """A vehicle at a new address has not heard our heartbeat yet, and obeys only who has introduced itself."""
        if peer not in self._greeted:
            if len(self._greeted) >= GREETED_KEPT:
                self._greeted.clear()
            self._greeted.add(peer)
            self._heartbeat_due, self._greet_until = now, now + GREETING

    def _handle_statustext(self, message: m.StatusText, system: int, now: float) -> None:
        text = self.log.handle_statustext(message, system, now)
        if text is not None:
            self._commander.handle_statustext(system, text, message.severity, now)

    # ---- what is told ----

    def _vehicle_view(self, contact: Contact, now: float) -> VehicleView:
        state, commander = contact.state, self._commander
        return state.build_view(
            now,
            in_control=self._driving.is_in_control(contact),
            emergency_stop=state.emergency_stop or commander.is_locked(state.system),
            refusal=commander.last_refusal(state.system),
            warnings=contact.settings_check.warnings if contact.settings_check else (),
        )

    def _waiting(self) -> str | None:
        if self._fleet.selected is not None:
            return None
        where = ", ".join(self._endpoints)
        if self._links.has_traffic:
            return f"data arrives on {where}, but no vehicle's heartbeat yet"
        return f"waiting for a vehicle on {where}"


_ORDERS: dict[type[i.Intent], Callable[[Commander, VehicleState, Any, float], None]] = {
    i.Arm: lambda commander, vehicle, _, now: commander.arm(vehicle, now),
    i.Disarm: lambda commander, vehicle, _, now: commander.disarm(vehicle, now),
    i.SetMode: lambda commander, vehicle, intent, now: commander.set_mode(vehicle, intent.mode, now),
    i.RequestControl: lambda commander, vehicle, _, now: commander.request_control(vehicle, now),
    i.EmergencyStop: lambda commander, vehicle, _, now: commander.emergency_stop(vehicle, now),
    i.ClearEmergencyStop: lambda commander, vehicle, _, now: commander.clear_emergency_stop(vehicle, now),
}
"""Orders to the selected vehicle."""

_INTENTS: dict[type[i.Intent], Callable[[Station, Any, float], None]] = {
    i.DriveKeyDown: Station._push,
    i.DriveKeyUp: Station._release,
    i.Stop: Station._stop,
    i.ScaleLimits: Station._change_speed,
    i.SetStyle: Station._set_style,
    i.ReportKeyReleases: Station._exact,
    i.SetKeyGate: Station._gate,
    i.RenewLease: Station._lease,
    i.SelectVehicle: Station._select,
    i.SelectNextVehicle: Station._select,
    i.Quit: Station._quit,
    **dict.fromkeys(_ORDERS, Station._order),
}
"""Intent -> what the station does. StartSimulator is the shell's (groundstation/station_process.py)."""
