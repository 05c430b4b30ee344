"""How much of each link telemetry and bulk answers may fill, from what the links say of themselves."""

from __future__ import annotations

from collections.abc import Sequence

from link.core import LinkReport, Peer
from link.services.pacing import DEFAULT_RATE, Pacer

TELEMETRY, BULK = 0.6, 0.3
"""Shares of a link whose capacity is known: streams, and lists, files and logs (30 to 50 % by the specification). The
rest is for acknowledgements and texts."""


class Bandwidth:
    """Bytes/s."""

    def __init__(self) -> None:
        self.telemetry: float | None = None
        """For all streams together, since they go out on every link alike: the slowest with a peer counts. None where
        nobody knows, as on a network."""
        self.pacer = Pacer(self._bulk)
        """One for every service that sends more than one answer."""
        self._room: dict[int, float] = {}

    def observe(self, reports: Sequence[LinkReport]) -> None:
        """Take what the links say."""
        self._room = {each.index: each.capacity * each.headroom for each in reports if each.capacity is not None}
        heard = [self._room[each.index] for each in reports if each.peers and each.index in self._room]
        self.telemetry = TELEMETRY * min(heard) if heard else None

    def _bulk(self, peer: Peer) -> float:
        room = self._room.get(peer.link)
        return DEFAULT_RATE if room is None else BULK * room
