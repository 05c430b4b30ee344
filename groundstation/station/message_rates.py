"""Counts and rates of the messages of each kind, received and sent."""

from __future__ import annotations

from dataclasses import dataclass, field

from dialects.messages import Message
from groundstation.snapshot import MessageRate
from link.protocol.rate import RateMeter

WINDOW = 3.0
"""s over which rates are counted: a 1 Hz message then shows as 1.0 and not as 0 or 1."""


@dataclass(slots=True)
class _Kind:
    meter: RateMeter = field(default_factory=lambda: RateMeter(WINDOW))
    count: int = 0


class MessageRates:
    """Rates by message name and direction; at most as many rows as the dialect has messages."""

    def __init__(self) -> None:
        self._kinds: dict[tuple[str, bool], _Kind] = {}

    def count(self, message: Message, now: float, *, sent: bool = False) -> None:
        """Count a message."""
        kind = self._kinds.setdefault((message.msgname, sent), _Kind())
        kind.meter.add(now)
        kind.count += 1

    def build_rates(self, now: float) -> tuple[MessageRate, ...]:
        """Return all rates, by name, received before sent."""
        return tuple(
            MessageRate(name=name, rate=kind.meter.rate(now), count=kind.count, sent=sent)
            for (name, sent), kind in sorted(self._kinds.items())
        )
