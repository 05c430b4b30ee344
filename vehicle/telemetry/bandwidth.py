"""How much of each link telemetry and bulk answers may fill, from what the links say of themselves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from link.core import LinkReport, Peer
from link.services.pacing import DEFAULT_RATE, BulkPacer


class LinkShares(NamedTuple):
    """Of a link whose capacity is known; the rest is for acknowledgements and texts."""

    telemetry: float
    """All streams together."""
    bulk: float
    """Lists, files and logs."""


DEFAULT_SHARES = LinkShares(0.6, 0.3)
"""30 to 50 % for parameters by the specification."""
DISARMED_SHARES = LinkShares(0.3, 0.6)
"""While bulk flows and nothing can be driven: a log takes half the time, and who waits for it reads no speedometer."""


class Bandwidth:
    """Bytes/s. `armed`: can the vehicle be driven now?"""

    def __init__(self, armed: Callable[[], bool]) -> None:
        self.telemetry_rates: dict[int, float] = {}
        """Link -> for all streams on it together; nobody knows that of a network."""
        self.pacer = BulkPacer(self._bulk)
        """One for every service that sends more than one answer."""
        self._armed = armed
        self._room: dict[int, float] = {}
        self._asked: set[int] = set()
        """Links that bulk was sent on since the last report ..."""
        self._busy: set[int] = set()
        """... and before it: what bulk gains telemetry has given up by then."""

    def update(self, reports: Sequence[LinkReport]) -> None:
        """Take what the links say."""
        self._busy, self._asked = self._asked, set()
        self._room = {each.index: each.capacity * each.headroom for each in reports if each.capacity is not None}
        self.telemetry_rates = {link: self._shares(link).telemetry * room for link, room in self._room.items()}

    def _bulk(self, peer: Peer) -> float:
        self._asked.add(peer.link)
        room = self._room.get(peer.link)
        return DEFAULT_RATE if room is None else self._shares(peer.link).bulk * room

    def _shares(self, link: int) -> LinkShares:
        return DISARMED_SHARES if link in self._busy and not self._armed() else DEFAULT_SHARES
