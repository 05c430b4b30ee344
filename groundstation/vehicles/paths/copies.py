"""Events that a vehicle tells over all paths at once: each is handed on once, whichever path brings it first.

A vehicle may tell the same twice. So what one path has brought n times is told n times, and a second path adds nothing
until it has brought it more often.
"""

from __future__ import annotations

from collections import Counter

import msgspec

from dialects import codec
from dialects import messages as m
from link.core import Peer

TOLD: frozenset[type[m.Message]] = frozenset({m.StatusText, m.MissionItemReached})
"""Events: neither state, of which the newest counts, nor answers, which go to the path of their question."""
KEPT = 64
"""Events remembered."""
WITHIN = 10.0
"""s after which the same words are told anew: no path is later by more."""

Told = tuple[int, bytes]


class _Event(msgspec.Struct):
    at: float
    told: int = 0
    brought: Counter[Peer] = msgspec.field(default_factory=Counter)


class EventCopies:
    """The newest events of one system."""

    def __init__(self) -> None:
        self._events: dict[Told, _Event] = {}

    def is_first(self, message: m.Message, component: int, peer: Peer, now: float) -> bool:
        """Return whether no other path has brought this event yet."""
        key = (component << 24 | type(message).id, codec.encode_payload(message))
        event = self._events.pop(key, None)
        if event is None or now - event.at > WITHIN:
            event = _Event(now)
        self._events[key] = event
        if len(self._events) > KEPT:
            del self._events[next(iter(self._events))]
        event.at = now
        event.brought[peer] += 1
        is_first = event.brought[peer] > event.told
        event.told = max(event.told, event.brought[peer])
        return is_first
