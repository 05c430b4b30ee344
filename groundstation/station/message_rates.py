"""Counts and rates of the messages of each kind, received and sent."""

from __future__ import annotations

from dataclasses import dataclass, field

from dialects.messages import Message
from groundstation.snapshot import MessageRate
from link.protocol.rate import RateMeter

WINDOW = 3.0
"""s over which rates are counted: a 1 Hz message then shows as 1.0 and not as 0 or 1."""


OURS = 0
"""In place of a system id: messages that this station sent."""


@dataclass(slots=True)
class _Kind:
    meter: RateMeter = field(default_factory=lambda: RateMeter(WINDOW))
    count: int = 0


class MessageRates:
    """Rates by sender and message name; at most as many rows as the dialect has messages for each vehicle."""

    def __init__(self) -> None:
        self._kinds: dict[tuple[int, str], _Kind] = {}

    def count(self, message: Message, now: float, *, system: int = OURS) -> None:
        """Count a message of the vehicle `system`, or one that we sent."""
        kind = self._kinds.setdefault((system, message.msgname), _Kind())
        kind.meter.add(now)
        kind.count += 1

    def build_rates(self, system: int, now: float) -> tuple[MessageRate, ...]:
        """Return the rates of one vehicle, by name, and those of what we sent to all."""
        return tuple(
            MessageRate(name=name, rate=kind.meter.rate(now), count=kind.count, sent=sender == OURS)
            for (sender, name), kind in sorted(self._kinds.items(), key=lambda row: row[0])
            if sender in (OURS, system)
        )
