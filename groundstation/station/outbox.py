"""StationOutbox: what the station sends next, in three lanes: demands, then commands, then services."""

from __future__ import annotations

from collections.abc import Sequence

from dialects.messages import Message
from link.core import Outgoing


class Demands:
    """The lane of demands: state of which the newest counts, and what verbs send in an order of their own."""

    def __init__(self) -> None:
        self.first: list[Outgoing] = []
        """Neutral demands with which those of a vehicle change to another path."""
        self._newest: dict[int, Sequence[Message]] = {}
        self.verbs: list[Outgoing] = []
        """All messages of verbs: a proof comes before what it proves, a neutral before the command after it."""

    def __contains__(self, system: int) -> bool:
        """Return whether a demand of the station's own operator waits for this vehicle."""
        return system in self._newest

    @property
    def waiting(self) -> bool:
        """Whether demands of the station's own operator wait."""
        return bool(self.first or self._newest)

    def replace(self, system: int, messages: Sequence[Message]) -> None:
        """Queue the newest demand of a vehicle, with its operator presence, in place of the one before."""
        self._newest[system] = messages

    def drop(self, system: int) -> None:
        """Drop the newest demand of a vehicle."""
        self._newest.pop(system, None)

    def drop_all(self) -> None:
        """Drop the newest demand of each vehicle."""
        self._newest.clear()

    def pop(self) -> list[Outgoing]:
        """Return what waits, and remove it."""
        newest = [Outgoing(message) for messages in self._newest.values() for message in messages]
        found = [*self.first, *newest, *self.verbs]
        self.first.clear()
        self._newest.clear()
        self.verbs.clear()
        return found


class StationOutbox:
    """The parts of a station put their messages into its lanes; a lane that is later gives way on a slow link."""

    def __init__(self) -> None:
        self.demands = Demands()
        self.commands: list[Outgoing] = []
        """Commands, questions, time and heartbeats, in the order in which they were made."""
        self.services: list[Outgoing] = []
        """Parameters, plans, files and logs, and commands that belong to them. All of it is repeated if it is lost."""

    def pop(self) -> list[Outgoing]:
        """Return what to send now, and remove it."""
        found = [*self.demands.pop(), *self.commands, *self.services]
        self.commands.clear()
        self.services.clear()
        return found
