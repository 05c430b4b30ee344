"""Who was heard where: the router's table, its caps and what expires. What happens to a frame is router.py's matter."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence

from link.protocol.framer import Framer
from link.routing.route_report import RouteReport, TransportReport

SourceId = tuple[int, int]
"""System and component."""

RecentFrames = list["tuple[float, RoutedPeer, bytes] | None"]
"""When a frame of this number came last, from whom, and its bytes."""

PEER_SILENCE = 30.0
"""s after which an address that came by itself (UDP) gets nothing more."""
ROUTE_SILENCE = 300.0
"""s after which a system is forgotten. Long on purpose: a vehicle that can no longer be heard may still hear a stop."""
MAX_PEERS = 32
"""Addresses on one wire."""
MAX_SOURCES = 64
"""Systems and components heard from one peer; frames of more are forwarded and teach nothing."""
LATE = 32
"""Frames at most this much older than the newest are late and not a restart."""


class RoutedSource:
    """One system and component, as heard from one peer."""

    __slots__ = (
        "component", "destinations", "epoch", "heard", "key", "lost", "next", "received", "recent", "system",
    )  # fmt: skip

    def __init__(self, key: SourceId, sequence: int, now: float) -> None:
        self.key = key
        self.system, self.component = key
        self.next = sequence
        """Number of the frame that follows the newest."""
        self.heard = now
        self.received = 0
        self.lost = 0
        self.destinations: dict[SourceId, tuple[RoutedPeer, ...]] = {}
        """Target -> where its frames go; valid while `epoch` is the router's."""
        self.epoch = -1
        self.recent: RecentFrames | None = None
        """Its newest frame of each number, from whichever peer; None where nobody compares them."""

    def count_frame(self, sequence: int, now: float) -> None:
        """One more frame of it."""
        self.heard = now
        self.received += 1
        ahead = (sequence - self.next) & 0xFF
        if ahead < 0xFF - LATE:
            self.lost += ahead
            self.next = (sequence + 1) & 0xFF
        elif ahead != 0xFF and self.lost:
            self.lost -= 1  # it was only overtaken


class RoutedPeer:
    """One address on one wire: to the router each is a link of its own."""

    __slots__ = (
        "address", "bytes_in", "bytes_out", "fixed", "framer", "frames_out", "heard", "link", "sources", "waiting",
    )  # fmt: skip

    def __init__(self, link: int, address: Hashable, now: float, *, stream: bool, fixed: bool = False) -> None:
        self.link = link
        self.address = address
        self.fixed = fixed
        """The user named it: it is sent to before it has spoken, and is never forgotten."""
        self.framer = Framer(stream=stream, unknown=True)
        self.heard = now
        self.sources: dict[SourceId, RoutedSource] = {}
        self.waiting: list[bytes] = []
        """Frames to send to it now."""
        self.bytes_in = self.frames_out = self.bytes_out = 0

    def report(self) -> TransportReport:
        """Return what this peer has carried."""
        counts = self.framer.counts
        return TransportReport(
            frames_in=counts.frames + counts.unknown,
            bytes_in=self.bytes_in,
            frames_out=self.frames_out,
            bytes_out=self.bytes_out,
            received=sum(each.received for each in self.sources.values()),
            lost=sum(each.lost for each in self.sources.values()),
            crc_errors=counts.crc_errors,
            noise_bytes=counts.resync_bytes,
            unknown=counts.unknown,
        )

    def has_system(self, system: int) -> bool:
        """Was any component of the system heard here?"""
        return any(each == system for each, _ in self.sources)


class RouteTable:
    """Peers and sources of all wires. `links` are the wires by number: (is it a stream, the address that is fixed)."""

    def __init__(self, links: Sequence[tuple[bool, Hashable | None]]) -> None:
        self.refused_peers = 0
        self.epoch = 0
        """Changes with every entry that comes or goes: what was derived from the table is then worth nothing."""
        self._streams = [stream for stream, _ in links]
        self._peers: list[dict[Hashable, RoutedPeer]] = [{} for _ in links]
        self._past = [TransportReport() for _ in links]
        """What peers carried that are gone."""
        for link, (stream, fixed) in enumerate(links):
            if fixed is not None:
                self._peers[link][fixed] = RoutedPeer(link, fixed, 0.0, stream=stream, fixed=True)

    def peers_of(self, link: int) -> dict[Hashable, RoutedPeer]:
        """The peers of one wire by address, for reading."""
        return self._peers[link]

    def is_stream(self, link: int) -> bool:
        """Does this wire know no datagrams?"""
        return self._streams[link]

    def all_peers(self) -> Iterator[RoutedPeer]:
        """All peers of all wires."""
        for peers in self._peers:
            yield from peers.values()

    def new_peer(self, link: int, address: Hashable, now: float) -> RoutedPeer | None:
        """Somebody who is not in the table yet; None when the wire is full. admit() takes him in."""
        peers = self._peers[link]
        if len(peers) < MAX_PEERS or self._most_silent(link, now):
            return RoutedPeer(link, address, now, stream=self._streams[link])
        self.refused_peers += 1
        return None

    def add_peer(self, peer: RoutedPeer, now: float) -> None:
        """Give a stranger a place, if need be that of the peer who has been silent longest."""
        peers = self._peers[peer.link]
        leaving = self._most_silent(peer.link, now) if len(peers) >= MAX_PEERS else None
        if leaving:
            self.remove_peer(leaving)
        peers[peer.address] = peer
        self.epoch += 1

    def reject_peer(self, peer: RoutedPeer) -> None:
        """Count what a stranger has sent, who was not let in."""
        self._past[peer.link].add(peer.report())

    def add_source(self, peer: RoutedPeer, source: RoutedSource) -> bool:
        """Enter a source; False when this peer has too many."""
        if len(peer.sources) >= MAX_SOURCES:
            return False
        peer.sources[source.key] = source
        self.epoch += 1
        return True

    def remove_other_routes(self, source: RoutedSource) -> None:
        """It has started anew, maybe on another wire: only where it speaks now is it at home."""
        for peer in self.all_peers():
            if peer.sources.get(source.key, source) is not source:
                del peer.sources[source.key]
        self.epoch += 1

    def handle_disconnect(self, link: int, address: Hashable) -> None:
        """The connection to `address` has ended."""
        peer = self._peers[link].get(address)
        if peer is None:
            return
        self.remove_peer(peer)
        if peer.fixed:
            self._peers[link][address] = RoutedPeer(link, address, peer.heard, stream=self._streams[link], fixed=True)

    def remove_peer(self, peer: RoutedPeer) -> None:
        """Take a peer out; what it carried still counts."""
        del self._peers[peer.link][peer.address]
        self._past[peer.link].add(peer.report())
        self.epoch += 1

    def expire(self, now: float) -> None:
        """Forget who is silent."""
        for peer in list(self.all_peers()):
            if not peer.fixed and not self._streams[peer.link] and now - peer.heard > PEER_SILENCE:
                self.remove_peer(peer)
                continue
            for key in [key for key, source in peer.sources.items() if now - source.heard > ROUTE_SILENCE]:
                del peer.sources[key]
                self.epoch += 1

    def known_sources(self) -> set[SourceId]:
        """Every source that was heard anywhere."""
        return {key for peer in self.all_peers() for key in peer.sources}

    def candidates(self, target: SourceId) -> list[RoutedPeer]:
        """Who a frame for `target` concerns: everybody, or where just this component was heard, or else its system."""
        system, component = target
        if not system:
            return list(self.all_peers())
        exact = [peer for peer in self.all_peers() if target in peer.sources] if component else []
        return exact or [peer for peer in self.all_peers() if peer.has_system(system)]

    def transport_reports(self) -> list[TransportReport]:
        """What each wire has carried, by number."""
        reports: list[TransportReport] = []
        for past, peers in zip(self._past, self._peers, strict=True):
            report = past.copy()
            report.peers = sum(1 for peer in peers.values() if peer.sources)
            for peer in peers.values():
                report.add(peer.report())
            reports.append(report)
        return reports

    def route_reports(self, now: float) -> list[RouteReport]:
        """Every system and component, where it was heard."""
        found = [
            RouteReport(*key, peer.link, peer.address, now - source.heard, source.received, source.lost)
            for peer in self.all_peers()
            for key, source in peer.sources.items()
        ]
        return sorted(found, key=lambda route: (route.system, route.component, route.link))

    def _most_silent(self, link: int, now: float) -> RoutedPeer | None:
        """Who must make room: nobody on a stream, whose connections end by themselves."""
        if self._streams[link]:
            return None
        silent = [peer for peer in self._peers[link].values() if not peer.fixed and now - peer.heard > PEER_SILENCE / 3]
        return min(silent, key=lambda peer: peer.heard, default=None)
