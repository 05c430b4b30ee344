"""What the station asks each vehicle by itself: what it is, telemetry, dangerous settings. Not the operator's orders.

Nothing here moves anything, and the operator hears of bad news only.
"""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Command, Severity
from groundstation.station.commander import Commander
from groundstation.station.link_stats import LinkBook
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.message_log import TextLog
from groundstation.vehicles.stream_requests import rate
from link.core import Outgoing


class Inquiry:
    """Asks one thing at a time, because commands of a kind are answered one at a time."""

    def __init__(self, fleet: Fleet, commander: Commander, links: LinkBook, log: TextLog) -> None:
        self._fleet = fleet
        self._commander = commander
        self._links = links
        self._log = log
        self._outbox: list[Outgoing] = []

    def receive(self, contact: Contact, message: m.Message, now: float) -> None:
        """Take a message of a vehicle."""
        contact.streams.receive(message, now)
        if isinstance(message, m.ParamValue) and contact.settings:
            warning = contact.settings.receive(message)
            if warning:
                self._log.add(now, "station", f"{contact.state.name}: {warning}", Severity.WARNING)

    def tick(self, now: float) -> None:
        """Ask who is there for what is due."""
        self._take_answers(now)
        for contact in self._fleet:
            if contact.lost_at is None:
                self._ask(contact, now)
                self._ask_for_telemetry(contact, now)

    def messages_to_send(self) -> list[Outgoing]:
        """What to send now; empties what it returns."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def _take_answers(self, now: float) -> None:
        for outcome in self._commander.quiet_outcomes():
            contact = self._fleet.get(outcome.target_system)
            if contact is None:
                continue
            if outcome.command == Command.SET_MESSAGE_INTERVAL:
                contact.streams.answered(outcome)
            else:
                contact.kinship.answered(outcome, now)

    def _ask(self, contact: Contact, now: float) -> None:
        state = contact.state
        asking = self._commander.busy(Command.REQUEST_MESSAGE, state)
        if not asking and contact.kinship.asks(state.autopilot, state.tells_ours(now), now):
            self._commander.ask_for(state, m.RoverDriveInfo.id, now)
        if contact.settings is not None:
            self._outbox += [Outgoing(message) for message in contact.settings.tick(now)]

    def _ask_for_telemetry(self, contact: Contact, now: float) -> None:
        """Never of our own rover: it tells what is needed, and sizes that to the link itself."""
        if contact.state.speaks_ours:
            return
        capacity = self._links.capacity(contact.link)
        self._outbox += [Outgoing(message) for message in contact.streams.groups(capacity, now)]
        if self._commander.busy(Command.SET_MESSAGE_INTERVAL, contact.state):
            return
        message = contact.streams.next(contact.state.autopilot, now)
        if message is not None:
            self._commander.set_rate(contact.state, message, rate(message, capacity), now)
