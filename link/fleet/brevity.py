"""Brief telemetry: what a vehicle sends to a ground station that does not look at it. Sans-IO.

All but telemetry goes to everybody: heartbeats, acknowledgements, texts, parameters and files. Of telemetry each kind
of message goes once a second, so that nothing is missing in a table of a hundred vehicles, and nothing outdated in it.
"""

from __future__ import annotations

from collections.abc import Collection

from link.fleet.presence import has_room
from link.fleet.traffic import TELEMETRY, traffic_class
from link.protocol.frame import Frame, Header

PERIOD = 0.9
"""s between two frames of one kind; a little less than 1 s, so that a stream of 1 Hz passes whole."""
MAX_KINDS = 512
"""Kinds of messages that are timed for one ground station."""


class BriefTelemetry:
    """Thins telemetry for the ground stations that asked for it."""

    def __init__(self) -> None:
        self._sent: dict[str, dict[tuple[int, int, int], float]] = {}
        """Address -> message, system and component -> when it was sent."""

    def set(self, address: str, *, is_brief: bool) -> None:
        """Record what a ground station wants. Without a word, or beyond the limits, it gets everything."""
        if not is_brief:
            self._sent.pop(address, None)
        elif has_room(address, self._sent):
            self._sent.setdefault(address, {})

    def keep(self, present: Collection[str]) -> None:
        """Forget the wishes of all ground stations that are not present: their tokens are not known any more."""
        self._sent = {address: times for address, times in self._sent.items() if address in present}

    def passes(self, frame: Frame | Header, address: str, now: float) -> bool:
        """Return whether to send a frame to an address now."""
        times = self._sent.get(address)
        if times is None or traffic_class(frame[0]) is not TELEMETRY:
            return True
        kind = frame[:3]
        if now - times.get(kind, -PERIOD) < PERIOD:
            return False
        if len(times) >= MAX_KINDS:
            times.clear()
        times[kind] = now
        return True
