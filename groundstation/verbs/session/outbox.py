"""VerbOutbox: what a verb sends next, in two lanes; the parts of the verb put their messages into them."""

from __future__ import annotations

from groundstation.station.verbs.running_verbs import VerbMessage
from link.core import Outgoing


class VerbOutbox:
    """A proof leaves before the command that it proves, and a neutral before the command after it."""

    def __init__(self) -> None:
        self.demands: list[VerbMessage] = []
        """Heartbeats, proofs and demands, in the order in which they were made."""
        self.commands: list[Outgoing] = []
        """Everything else, to all or to the target of the message."""

    def pop(self) -> list[VerbMessage]:
        """Return what to send now, and remove it."""
        found = [*self.demands, *(VerbMessage(each.message) for each in self.commands)]
        self.demands.clear()
        self.commands.clear()
        return found
