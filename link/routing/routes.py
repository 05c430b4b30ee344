"""Route table: which systems were seen behind which peers, its limits and timeouts. router.py uses it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterator, Sequence

from link.protocol.framer import Framer
from link.routing.route_report import RouteReport, TransportReport

SourceId = tuple[int, int]
"""System and component."""

RecentFrames = list["tuple[float, RoutedPeer, bytes] | None"]
"""For each sequence number: when the newest frame came, from which peer, and its bytes."""

PEER_SILENCE = 30.0
"""s without a frame after which a UDP peer gets nothing more."""
PASSING = 2.0
"""s without a frame after which a UDP peer with fewer than FEW frames gives up its place: every program that stays
sends a HEARTBEAT each second."""
FEW = 3
ROUTE_SILENCE = 300.0
"""s after which a system is forgotten. Long on purpose: a vehicle that cannot be received may still receive a stop."""
MAX_PEERS = 128
"""Addresses on one link: a hundred ground stations take half a core at 500 messages/s (docs/performance.md)."""
STOP_PLACES = 8
"""Further places for senders of a stop, of which the newest have them: stopping a vehicle needs no place."""
OWNER_PLACES = 4
"""Places that a host keeps when others need them. An operator of a fleet has no more."""
MAX_SOURCES = 64
"""Systems and components tracked behind one peer; frames of further ones are forwarded but teach no route."""
LATE = 32
"""Frames up to this much older than the newest are late; older ones are a restart."""


class RoutedSource:
    """One system and component, as seen behind one peer."""

    __slots__ = (
        "component",
        "destinations",
        "epoch",
        "key",
        "last_seen",
        "lost",
        "next",
        "received",
        "recent",
        "system",
    )  # fmt: skip

    def __init__(self, key: SourceId, sequence: int, now: float) -> None:
        self.key = key
        self.system, self.component = key
        self.next = sequence
        """Sequence number after the newest frame."""
        self.last_seen = now
        self.received = 0
        self.lost = 0
        self.destinations: dict[SourceId, tuple[RoutedPeer, ...]] = {}
        """Target -> peers; valid while `epoch` is the table's."""
        self.epoch = -1
        self.recent: RecentFrames | None = None
        """Its newest frames of all peers; None where frames are not compared."""

    def count_frame(self, sequence: int, now: float) -> None:
        """Count one frame."""
        self.last_seen = now
        self.received += 1
        ahead = (sequence - self.next) & 0xFF
        if ahead < 0xFF - LATE:
            self.lost += ahead
            self.next = (sequence + 1) & 0xFF
        elif ahead != 0xFF and self.lost:
            self.lost -= 1  # the frame was only overtaken


class RoutedPeer:
    """One address on one link. The router treats each as a link of its own."""

    __slots__ = (
        "address", "bytes_in", "bytes_out", "connected", "fixed", "framer", "frames_out", "guest", "last_seen", "link",
        "sources", "waiting",
    )  # fmt: skip

    def __init__(self, link: int, address: Hashable, now: float, *, stream: bool, fixed: bool = False) -> None:
        self.link = link
        self.address = address
        self.fixed = fixed
        """The user named it: it is sent to before its first frame, and is never forgotten."""
        self.connected = False
        """It has opened a connection: it is sent to before its first frame, too, or two bridges would wait for ever."""
        self.guest = False
        """It has one of STOP_PLACES."""
        self.framer = Framer(stream=stream, unknown=True)
        self.last_seen = now
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

    @property
    def owner(self) -> Hashable:
        """Whose address it is: the operator of a run in a fleet, as of "alice/3f2a", or a host."""
        host: Hashable = self.address[0] if isinstance(self.address, tuple) else str(self.address).partition("/")[0]
        return host

    def has_system(self, system: int) -> bool:
        """Return whether any component of the system was seen here."""
        return any(each == system for each, _ in self.sources)


class RouteTable:
    """Peers and sources of all links. `links`, by index: (is it a stream, its fixed address or None)."""

    def __init__(self, links: Sequence[tuple[bool, Hashable | None]]) -> None:
        self.refused_peers = 0
        self.epoch = 0
        """Changes with every entry that is added or removed, and so invalidates what was derived from the table."""
        self._streams: dict[int, bool] = {}
        self._peers: dict[int, dict[Hashable, RoutedPeer]] = {}
        self._past: dict[int, TransportReport] = {}
        """Traffic of peers that were removed."""
        for link, (stream, fixed) in enumerate(links):
            self.add_link(link, stream, fixed)

    def add_link(self, link: int, stream: bool, fixed: Hashable | None) -> None:
        """Add a link; its index was not used before."""
        self._streams[link], self._peers[link], self._past[link] = stream, {}, TransportReport()
        if fixed is not None:
            self._peers[link][fixed] = RoutedPeer(link, fixed, 0.0, stream=stream, fixed=True)
        self.epoch += 1

    def remove_link(self, link: int) -> None:
        """Forget a link with all that was seen behind it."""
        del self._streams[link], self._peers[link], self._past[link]
        self.epoch += 1

    def peers_of(self, link: int) -> dict[Hashable, RoutedPeer]:
        """Return the peers of one link by address, to be read only."""
        return self._peers[link]

    def is_stream(self, link: int) -> bool:
        """Return whether this link is a stream, without datagrams."""
        return self._streams[link]

    @property
    def has_streams(self) -> bool:
        """Whether a link is a stream: only there a frame may be incomplete."""
        return True in self._streams.values()

    def all_peers(self) -> Iterator[RoutedPeer]:
        """Yield all peers of all links."""
        for peers in self._peers.values():
            yield from peers.values()

    def new_peer(self, link: int, address: Hashable, now: float) -> RoutedPeer:
        """Return a peer for admit()."""
        return RoutedPeer(link, address, now, stream=self._streams[link])

    def admit(self, peer: RoutedPeer, now: float, *, stops: bool) -> bool:
        """Add a peer, if need be in place of another one; return False if there is no place.

        `stops`: it has sent a stop, which needs none.
        """
        peers = self._peers[peer.link]
        guests = [each for each in peers.values() if each.guest]
        if len(peers) - len(guests) >= MAX_PEERS:
            leaving = self._find_leaving(peer, now)
            if leaving is None and not stops:
                self.refused_peers += 1
                return False
            peer.guest = leaving is None
            if peer.guest and len(guests) >= STOP_PLACES:
                leaving = min(guests, key=lambda each: each.last_seen)
            if leaving is not None:
                self.remove_peer(leaving)
        peers[peer.address] = peer
        self.epoch += 1
        return True

    def reject_peer(self, peer: RoutedPeer) -> None:
        """Count the traffic of a peer that was not added."""
        self._past[peer.link].add(peer.report())

    def add_source(self, peer: RoutedPeer, source: RoutedSource) -> bool:
        """Add a source; return False when this peer has too many."""
        if len(peer.sources) >= MAX_SOURCES:
            return False
        peer.sources[source.key] = source
        self.epoch += 1
        return True

    def remove_other_routes(self, source: RoutedSource) -> None:
        """Forget the source on all other peers, after it has restarted, maybe on another link."""
        for peer in self.all_peers():
            if peer.sources.get(source.key, source) is not source:
                del peer.sources[source.key]
        self.epoch += 1

    def handle_disconnect(self, link: int, address: Hashable) -> None:
        """Handle the end of the connection to `address`."""
        peer = self._peers[link].get(address)
        if peer is None:
            return
        self.remove_peer(peer)
        if peer.fixed:
            self._peers[link][address] = RoutedPeer(
                link, address, peer.last_seen, stream=self._streams[link], fixed=True
            )

    def remove_peer(self, peer: RoutedPeer) -> None:
        """Remove a peer; its traffic still counts."""
        del self._peers[peer.link][peer.address]
        self._past[peer.link].add(peer.report())
        self.epoch += 1

    def expire(self, now: float) -> None:
        """Forget silent peers and sources."""
        for peer in list(self.all_peers()):
            if not peer.fixed and not self._streams[peer.link] and now - peer.last_seen > PEER_SILENCE:
                self.remove_peer(peer)
                continue
            for key in [key for key, source in peer.sources.items() if now - source.last_seen > ROUTE_SILENCE]:
                del peer.sources[key]
                self.epoch += 1

    def known_sources(self) -> set[SourceId]:
        """Return every source that was seen behind any peer."""
        return {key for peer in self.all_peers() for key in peer.sources}

    def candidates(self, target: SourceId) -> list[RoutedPeer]:
        """Return the peers that a frame for `target` concerns.

        All of them for a broadcast; else those behind which the component was seen, or if none, its system.
        """
        system, component = target
        if not system:
            return list(self.all_peers())
        exact = [peer for peer in self.all_peers() if target in peer.sources] if component else []
        return exact or [peer for peer in self.all_peers() if peer.has_system(system)]

    def transport_reports(self) -> list[TransportReport]:
        """Return the traffic of each link, in the order in which they were added."""
        reports: list[TransportReport] = []
        for past, peers in zip(self._past.values(), self._peers.values(), strict=True):
            report = past.copy()
            report.peers = sum(1 for peer in peers.values() if peer.sources)
            for peer in peers.values():
                report.add(peer.report())
            reports.append(report)
        return reports

    def route_reports(self, now: float) -> list[RouteReport]:
        """Return every system and component, with the peer where it was seen."""
        found = [
            RouteReport(*key, peer.link, peer.address, now - source.last_seen, source.received, source.lost)
            for peer in self.all_peers()
            for key, source in peer.sources.items()
        ]
        return sorted(found, key=lambda route: (route.system, route.component, route.link))

    def _find_leaving(self, peer: RoutedPeer, now: float) -> RoutedPeer | None:
        """Return the peer that leaves its place to a new one.

        One that has been silent, but no connection, which ends by itself. Else one of the owner with the most places,
        if that has more than it may keep and at least two more than the owner of the new one.
        """
        peers = [each for each in self._peers[peer.link].values() if not each.fixed and not each.guest]
        absent = [] if self._streams[peer.link] else [each for each in peers if _is_absent(each, now)]
        if absent:
            return min(absent, key=lambda each: each.last_seen)
        places = Counter([each.owner for each in peers])
        owner, most = max(places.items(), key=lambda each: each[1])
        if most < max(OWNER_PLACES + 1, places[peer.owner] + 2):
            return None
        return min((each for each in peers if each.owner == owner), key=lambda each: each.last_seen)


def _is_absent(peer: RoutedPeer, now: float) -> bool:
    """Return whether a UDP peer has been silent for so long that another one may have its place."""
    silence = now - peer.last_seen
    return silence > PEER_SILENCE / 3 or (silence > PASSING and peer.framer.counts.frames < FEW)
