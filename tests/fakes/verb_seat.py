"""The seat of a verb in a station, for tests that speak for the verb."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from dialects.messages import Message
from groundstation.station.verbs.running_verbs import RunningVerb
from link.core import LinkReport, Received


@dataclass
class SeatLog:
    """Keeps what the station tells its verb."""

    heard: list[Received] = field(default_factory=list)
    refusals: list[str] = field(default_factory=list)
    """Why demands are not sent."""
    refused: list[tuple[Message, str]] = field(default_factory=list)
    """Messages that a role does not allow, and why."""

    def deliver(self, received: Received, now: float) -> None:
        self.heard.append(received)

    def report(self, reports: Sequence[LinkReport], now: float) -> None:
        """Ignore the links."""

    def refuse(self, line: str) -> None:
        self.refusals.append(line)

    def tell_refusal(self, message: Message, why: str, now: float) -> None:
        self.refused.append((message, why))

    def tick(self, now: float) -> None:
        """Do nothing."""


def verb_of(
    name: str, *, needs_session: bool = False, follows: bool = False, moves: bool = False, seat: SeatLog | None = None
) -> RunningVerb:
    """Return a verb for a station to join."""
    return RunningVerb(name, needs_session, seat or SeatLog(), follows=follows, moves=moves)
