"""Forwards frames between links by system and component id, without decoding or changing them.

Rules (https://mavlink.io/en/guide/routing.html): a broadcast goes to every other peer, a frame for one system only
where that system was seen. No frame goes back to its origin, nor to a peer behind which its sender was seen. Messages
with the trait LOCAL are not forwarded. Frames that cannot be verified (unknown ids, signatures) are forwarded, but only
verified frames teach routes. A frame that arrives over two redundant links is forwarded once. Every table is bounded.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from typing import NamedTuple

from dialects.codec import CRC_EXTRA
from dialects.messages import SystemTime
from dialects.targets import TARGETS, target_of
from dialects.traits import LOCAL
from link.protocol.frame import Frame, payload_of
from link.protocol.stops import find_stops
from link.routing.routes import RecentFrames, RoutedPeer, RoutedSource, RouteTable, SourceId

REDUNDANCY_WINDOW = 1.0
"""s in which an equal frame over another link is a repeat: longer than the slowest radio's delay, and shorter than 256
frames of one sender take, unless it sends more of them than redundant links carry."""
MAX_RECENT_UNTRACKED = 512
"""Frames of untracked sources that are remembered for REDUNDANCY_WINDOW: without them, one frame with an unknown id
circles for ever in a ring of bridges, because it teaches no route and has no entry to compare it with."""
MAX_TRACKED_SOURCES = 256
"""Systems and components whose frames are compared between redundant links."""
MAX_TARGETS = 256
"""Targets of one source whose destinations are cached."""

FORGET_PERIOD = 1.0
"""s between two looks for silent peers: the shortest silence that counts is 30 s."""

_EVERYBODY: SourceId = (0, 0)
_INSPECTED = LOCAL | {SystemTime.id}


class Delivery(NamedTuple):
    """Frames to send to one address of one link, in this order."""

    link: int
    address: Hashable
    frames: list[bytes]


class Router:
    """Decides where each frame goes. `links`: see RouteTable.

    `own`: ids of a host that also routes. Frames for it alone end here, and its own frames that come back are dropped.
    """

    def __init__(self, links: Sequence[tuple[bool, Hashable | None]], *, own: SourceId | None = None) -> None:
        self.table = RouteTable(links)
        self.duplicates = 0
        """Repeats that redundant links brought."""
        self.captured: list[bytes] | None = None
        """If a list: every frame that arrives, in order, for a recorder to take away."""
        self._own = own
        self._not_for_all = _INSPECTED | TARGETS.keys()
        """Any other message is a broadcast, whatever its payload."""
        self._recent: dict[SourceId, RecentFrames] = {}
        """One per source, shared by all peers, so that their frames can be compared."""
        self._untracked: dict[bytes, float] = {}
        """Frames of sources without `recent` -> when each arrived first; the oldest first."""
        self._boot_times: dict[SourceId, int] = {}
        self._loaded: list[RoutedPeer] = []
        self._forget_due = -math.inf

    def receive(self, link: int, pieces: Sequence[tuple[bytes, Hashable]], now: float) -> list[Delivery]:
        """Handle the bytes that arrived on a link; return what to send where. `now` in s, monotonic."""
        peers = self.table.peers_of(link)
        for data, address in pieces:
            peer = peers.get(address)
            if peer is None:
                self._receive_from_new_peer(link, data, address, now)
                continue
            peer.bytes_in += len(data)
            frames = peer.framer.feed(data, now)
            if frames:
                self._forward(peer, frames, now)
        return self._collect()

    def tick(self, now: float) -> list[Delivery]:
        """Give up overdue partial frames, and now and then forget silent peers. Call it every 50 ms or so."""
        if self.table.has_streams:
            for peer in list(self.table.all_peers()):
                frames = peer.framer.expire(now)
                if frames:
                    self._forward(peer, frames, now)
        if now >= self._forget_due:
            self._forget_due = now + FORGET_PERIOD
            self._forget_silent(now)
        return self._collect()

    def _forget_silent(self, now: float) -> None:
        self.table.expire(now)
        known = self.table.known_sources()
        for followed in (self._recent, self._boot_times):
            for key in followed.keys() - known:
                del followed[key]

    def broadcast_links(self, link: int, key: SourceId) -> set[int]:
        """Return the links to which a broadcast of a source that was seen on `link` goes now."""
        return {
            destination.link
            for peer in self.table.peers_of(link).values()
            if key in peer.sources
            for destination in self._destinations(peer, peer.sources[key], _EVERYBODY)
        }

    # ---- one frame ----

    def _receive_from_new_peer(self, link: int, data: bytes, address: Hashable, now: float) -> None:
        """Add a peer: on UDP only for a verified frame, on a stream for any connection."""
        peer = self.table.new_peer(link, address, now)
        peer.bytes_in += len(data)
        frames = peer.framer.feed(data, now)
        is_stream = self.table.is_stream(link)
        peer.connected = is_stream and not data
        stops = any(find_stops(frames, _EVERYBODY, None))
        known = is_stream or any(message_id in CRC_EXTRA for message_id, *_ in frames)
        if known and self.table.admit(peer, now, stops=stops):
            self._forward(peer, frames, now)
        elif not known:
            self.table.reject_peer(peer)

    def _forward(self, peer: RoutedPeer, frames: list[Frame], now: float) -> None:  # noqa: C901 - calls cost more here
        """Forward frames, on the hot path.

        A frame of a known source costs no call here but list.append, dict.get and target_of.
        """
        peer.last_seen = now
        sources, loaded, table, not_for_all = peer.sources, self._loaded, self.table, self._not_for_all
        known: RoutedSource | None = None
        if self.captured is not None:
            self.captured += [raw for _, _, _, _, raw in frames]
        for frame in frames:
            message_id, system, component, sequence, raw = frame
            if known is None or known.system != system or known.component != component:
                known = sources.get((system, component))
            source = known or self._learn(peer, frame, now)
            if source is None:
                continue
            if sequence == source.next:
                source.received += 1
                source.last_seen, source.next = now, (sequence + 1) & 0xFF
            else:
                source.count_frame(sequence, now)
            recent = source.recent
            if recent is not None:
                before = recent[sequence]
                if before is not None and before[1] is not peer and self._is_redundant(before, raw, now):
                    continue
                recent[sequence] = (now, peer, raw)
            elif self._is_untracked_copy(raw, now):
                continue
            target = _EVERYBODY
            if message_id in not_for_all:
                if message_id in _INSPECTED and self._is_link_local(source, message_id, raw):
                    continue
                target = target_of(message_id, raw)
            found = source.destinations.get(target) if source.epoch == table.epoch else None
            for destination in self._destinations(peer, source, target) if found is None else found:
                if not destination.waiting:
                    loaded.append(destination)
                destination.waiting.append(raw)

    def _learn(self, peer: RoutedPeer, frame: Frame, now: float) -> RoutedSource | None:
        """Return the entry of a source that is new on this peer; None for frames that go nowhere."""
        message_id, system, component, sequence, _ = frame
        key = (system, component)
        if not system or key == self._own:  # component 0 is valid: pymavlink sends it by default
            return None
        source = RoutedSource(key, sequence, now)
        source.recent = self._recent.get(key)
        if message_id not in CRC_EXTRA or not self.table.add_source(peer, source):
            return source  # the frame is forwarded, but teaches no route
        if source.recent is None and len(self._recent) < MAX_TRACKED_SOURCES:
            source.recent = self._recent[key] = [None] * 256
        return source

    def _is_redundant(self, before: tuple[float, RoutedPeer, bytes], raw: bytes, now: float) -> bool:
        """Return whether another link has brought this frame already, with the same signature.

        One with another signature goes on as well: without keys nobody knows which of the two is genuine, and a forged
        one that comes first must not keep the genuine one away. The receiver counts one of them.
        """
        again = now - before[0] < REDUNDANCY_WINDOW and before[2] == raw
        self.duplicates += again
        return again

    def _is_untracked_copy(self, raw: bytes, now: float) -> bool:
        """Return whether this frame of an untracked source went on less than REDUNDANCY_WINDOW ago, on any link."""
        at = self._untracked.get(raw)
        if at is not None and now - at < REDUNDANCY_WINDOW:
            self.duplicates += 1
            return True
        self._untracked.pop(raw, None)
        if len(self._untracked) >= MAX_RECENT_UNTRACKED:
            del self._untracked[next(iter(self._untracked))]
        self._untracked[raw] = now
        return False

    def _is_link_local(self, source: RoutedSource, message_id: int, raw: bytes) -> bool:
        """Handle messages that the router reads: return True for LOCAL ones; SYSTEM_TIME reveals a restart."""
        if message_id in LOCAL:
            return True
        boot_time = int.from_bytes(payload_of(raw)[8:12], "little")
        if boot_time < self._boot_times.get(source.key, 0):
            self.table.remove_other_routes(source)
        if source.key in self._boot_times or len(self._boot_times) < MAX_TRACKED_SOURCES:
            self._boot_times[source.key] = boot_time
        return False

    def _destinations(self, origin: RoutedPeer, source: RoutedSource, target: SourceId) -> tuple[RoutedPeer, ...]:
        """Return the peers that a frame for `target` goes to; cached until the table changes."""
        if source.epoch != self.table.epoch or len(source.destinations) > MAX_TARGETS:
            source.destinations, source.epoch = {}, self.table.epoch
        found = source.destinations.get(target)
        if found is None:
            found = source.destinations[target] = tuple(
                peer
                for peer in (() if target == self._own else self.table.candidates(target))
                if peer is not origin
                and source.key not in peer.sources
                and (peer.sources or peer.fixed or peer.connected)
            )
        return found

    def _collect(self) -> list[Delivery]:
        deliveries: list[Delivery] = []
        for peer in self._loaded:
            frames, peer.waiting = peer.waiting, []
            peer.frames_out += len(frames)
            peer.bytes_out += sum(map(len, frames))
            deliveries.append(Delivery(peer.link, peer.address, frames))
        self._loaded = []
        return deliveries
