"""Queries that the station sends on its own: the vehicle's dialect, its telemetry streams, its dangerous settings.

Nothing here moves a vehicle. Only restarts and bad news are logged.
"""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Command, Severity
from groundstation.snapshot.log_origin import LogOrigin
from groundstation.station.driving.commander import Commander
from groundstation.station.links.link_stats import LinkStats
from groundstation.station.outbox import StationOutbox
from groundstation.station.services.service_requests import ServiceRequests
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.probes.dialect_probe import FOREIGN_AUTOPILOTS
from groundstation.vehicles.probes.stream_requests import stream_rate
from groundstation.vehicles.state.message_log import MessageLog
from link.core import Outgoing, Received

VERSION_TRIES, VERSION_PERIOD = 3, 2.0
"""How often AUTOPILOT_VERSION is requested of a vehicle, and s between: a vehicle may accept and not send it."""


HOME_DELAY, HOME_TRIES, HOME_PERIOD = 2.0, 3, 10.0
"""s in which a vehicle may send HOME_POSITION by itself; how often it is requested, and s between. A vehicle without a
home sends it when it has one."""


class VehicleQueries:
    """Queries each vehicle, one command of a kind at a time, because they are acknowledged one at a time."""

    def __init__(
        self,
        fleet: Fleet,
        commander: Commander,
        links: LinkStats,
        log: MessageLog,
        services: ServiceRequests,
        outbox: StationOutbox,
    ) -> None:
        self._services = services
        self._fleet = fleet
        self._commander = commander
        self._links = links
        self._log = log
        self._outbox = outbox.commands
        self._versions: dict[int, tuple[int, float]] = {}
        """System id -> how often its AUTOPILOT_VERSION was requested, and when it may be again."""
        self._homes: dict[tuple[int, int], tuple[int, float]] = {}
        """System and component -> how often HOME_POSITION was requested, and when it may be again."""

    def receive(self, contact: Contact, received: Received, now: float) -> None:
        """Handle a message of a vehicle."""
        own = received.component == contact.state.component  # another component has a clock of its own
        if own and contact.stream_requests.handle_message(received.message, now):
            contact.check_settings_again()
            contact.state.restart()
            origin = LogOrigin(contact.state.system)
            text = f"{contact.state.name} has restarted: its settings are read again"
            self._log.add(now, "station", text, Severity.WARNING, origin=origin)
            contact.details.home = None
            self._homes.pop((received.system, received.component), None)
        if contact.settings_check is not None:
            self._log_warnings(contact, contact.settings_check.receive(received, now), now)

    def tick(self, now: float) -> None:
        """Send the queries that are due to the vehicles that are there."""
        self._handle_outcomes(now)
        for contact in self._fleet:
            if contact.lost_at is None:
                self._query_dialect(contact, now)
                self._query_settings(contact, now)
                self._query_params(contact, now)
                self._request_telemetry(contact, now)
                self._request_home(contact, now)

    def find_dialect(self, contact: Contact, now: float) -> None:
        """Ask a vehicle for its dialect, if that is due: a verb waits for it, which may run without a screen."""
        self._handle_outcomes(now)
        self._query_dialect(contact, now)

    def request_version(self, contact: Contact, now: float) -> None:
        """Request AUTOPILOT_VERSION, if it is not known: called while a screen shows it."""
        state = contact.state
        tries, due = self._versions.get(state.system, (0, now))
        wanted = not contact.details.firmware and contact.lost_at is None and tries < VERSION_TRIES and now >= due
        if wanted and not self._is_requesting(contact):
            self._versions[state.system] = (tries + 1, now + VERSION_PERIOD)
            self._commander.request_message(state, m.AutopilotVersion.id, now)

    def _request_home(self, contact: Contact, now: float) -> None:
        """Request HOME_POSITION of ArduPilot and PX4: ArduPilot sends it only when it changes."""
        state = contact.state
        tries, due = self._homes.get((state.system, state.component), (0, now + HOME_DELAY))
        if state.autopilot not in FOREIGN_AUTOPILOTS or contact.details.home is not None or tries >= HOME_TRIES:
            return
        if now >= due and not self._is_requesting(contact):
            self._commander.request_message(state, m.HomePosition.id, now)
            tries, due = tries + 1, now + HOME_PERIOD
        self._homes[state.system, state.component] = tries, due

    def _is_requesting(self, contact: Contact) -> bool:
        """Return whether a REQUEST_MESSAGE is not acknowledged yet: another one would take its answer."""
        pending = self._commander.is_pending(Command.REQUEST_MESSAGE, contact.state)
        return pending or self._services.is_querying(contact)

    def _handle_outcomes(self, now: float) -> None:
        for outcome in self._commander.pop_query_outcomes():
            contact = self._fleet.get(outcome.target_system)
            if contact is None:
                continue
            if outcome.command == Command.SET_MESSAGE_INTERVAL:
                contact.stream_requests.handle_outcome(outcome)
            elif outcome.params[0] == m.RoverDriveInfo.id:
                contact.dialect_probe.handle_outcome(outcome, now)

    def _query_dialect(self, contact: Contact, now: float) -> None:
        state = contact.state
        if not self._is_requesting(contact) and contact.dialect_probe.is_due(
            state.autopilot, state.sends_drive_status(now), now
        ):
            self._commander.request_message(state, m.RoverDriveInfo.id, now)

    def _query_settings(self, contact: Contact, now: float) -> None:
        if contact.settings_check is not None:
            self._outbox += contact.settings_check.tick(now)
            self._log_warnings(contact, contact.settings_check.pop_missing_warning(), now)

    def _query_params(self, contact: Contact, now: float) -> None:
        self._outbox += contact.drive.params.tick(now)

    def _log_warnings(self, contact: Contact, warnings: list[str], now: float) -> None:
        for warning in warnings:
            self._log.add(now, "station", f"{contact.state.name}: {warning}", Severity.WARNING)

    def _request_telemetry(self, contact: Contact, now: float) -> None:
        """Request telemetry, but not from our own rover: it sends what is needed and fits that to the link itself."""
        if contact.state.has_rover_dialect:
            return
        capacity = self._links.capacity(contact.link)
        self._outbox += [Outgoing(message) for message in contact.stream_requests.due_group_requests(capacity, now)]
        pending = self._commander.is_pending(Command.SET_MESSAGE_INTERVAL, contact.state)
        if pending or self._services.is_setting_rate(contact):
            return
        state = contact.state
        message = contact.stream_requests.next_message(state.autopilot, now, flies=state.model.flies)
        if message is not None:
            self._commander.set_message_interval(state, message, stream_rate(message, capacity), now)
