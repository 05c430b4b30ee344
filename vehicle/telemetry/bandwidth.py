"""How much of each link telemetry and bulk transfers may use, from the reports of the links."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from link.core import LinkReport, Peer
from link.endpoint import is_loopback
from link.services.pacing import DEFAULT_RATE, LOCAL_FILE_RATE, BulkPacer
from vehicle.safety.state_machine import Safety


class LinkShares(NamedTuple):
    """Shares of a link with a known capacity; the rest is for acknowledgements and texts."""

    telemetry: float
    """All streams together, 0..1."""
    bulk: float
    """Parameter lists, plans, files and logs, 0..1."""


DEFAULT_SHARES = LinkShares(0.6, 0.3)
"""The parameter protocol recommends 30 to 50 % of the link for a list (mavlink.io/en/services/parameter.html)."""
DISARMED_SHARES = LinkShares(0.12, 0.84)
"""During a bulk transfer while disarmed: a log takes a third of the time, and telemetry matters less."""


class Bandwidth:
    """Shares out the links, in bytes/s."""

    def __init__(self, safety: Safety, is_station: Callable[[Peer], bool] = lambda peer: False) -> None:
        """`is_station` returns whether a peer has the dialect of this project."""
        self.telemetry_rates: dict[int, float] = {}
        """Link -> bytes/s of all its streams; only for links with a known capacity."""
        self.pacer = BulkPacer(self._bulk)
        """Paces every service that sends more than one answer, but for files."""
        self.file_pacer = BulkPacer(self._files)
        """Paces files."""
        self._is_station = is_station
        self._safety = safety
        self._room: dict[int, float] = {}
        self._used: set[int] = set()
        """Links with bulk transfers since the last report."""
        self._busy: set[int] = set()
        """Links with bulk transfers before the last report: telemetry has made room there by now."""

    def update(self, reports: Sequence[LinkReport]) -> None:
        """Store the reports of the links, about once a second."""
        self._busy, self._used = self._used, set()
        self._room = {each.index: each.capacity * each.headroom for each in reports if each.capacity is not None}
        self.telemetry_rates = {link: self._shares(link).telemetry * room for link, room in self._room.items()}

    def _bulk(self, peer: Peer) -> float:
        self._used.add(peer.link)
        room = self._room.get(peer.link)
        return DEFAULT_RATE if room is None else self._shares(peer.link).bulk * room

    def _files(self, peer: Peer) -> float:
        """Return the rate of files: that of other bulk, but to a station on the same machine while nobody drives."""
        rate = self._bulk(peer)
        if rate != DEFAULT_RATE or self._safety.armed or self.file_pacer.is_lossy(peer):
            return rate
        return LOCAL_FILE_RATE if self._is_station(peer) and _is_local(peer) else rate

    def _shares(self, link: int) -> LinkShares:
        return DISARMED_SHARES if link in self._busy and not self._safety.armed else DEFAULT_SHARES


def _is_local(peer: Peer) -> bool:
    """Return whether a peer is on this machine; an address on a network is (host, port, ...)."""
    return isinstance(peer.address, tuple) and is_loopback(str(peer.address[0]))
