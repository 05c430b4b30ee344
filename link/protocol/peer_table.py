"""The peers of a channel: who has a place, who gives it up, and which conversation each is in."""

from __future__ import annotations

import re
from collections.abc import Hashable, Iterable, Iterator
from itertools import count

from dialects.messages import target_system
from dialects.traits import LOG_ONLY
from link.core import Outgoing, Peer
from link.endpoint import FLEET_NAME
from link.protocol.frame import Frame, FramerCounts
from link.protocol.framer import Framer
from link.protocol.peer import PeerState

MAX_PEERS = 24
"""Sixteen ground stations on one port, and room for half of them to restart: a restarted program has a new port, and
its old place is not free before PEER_SILENCE. More cost little: their tables are bounded, and what the vehicle streams
to all peers of a link has one budget (vehicle/telemetry/telemetry.py)."""
RESERVED_PLACES = 4
"""Further places for the ids of the ground station in control: it may come from another address when all others are
taken."""
PEER_SILENCE = 10.0
"""s without a frame after which a peer gives up its place; twice the longest usual heartbeat timeout."""


class PeerTable:
    """The peers of link `index` by address, at most `places`. `stream`: bytes have no datagram boundaries.

    `first_sequence` is the packet sequence, 0..255, of the first frame to each peer. `named`: an address is the name of
    its program.
    """

    def __init__(
        self, index: int, *, stream: bool, places: int = MAX_PEERS, first_sequence: int = 0, named: bool = False
    ) -> None:
        self.past_counts = FramerCounts()
        """Of the peers that have gone."""
        self.refused = 0
        """Datagrams of senders for whom there was no place."""
        self.reserved_ids: tuple[int, int] | None = None
        """System and component id for which places are kept."""
        self.transient: PeerState | None = None
        """The newest sender of a stop for whom there was no place, so that the stop can be acknowledged."""
        self._index = index
        self._stream = stream
        self._places = places
        self._first_sequence = first_sequence
        self._named = named
        self._states: dict[Hashable, PeerState] = {}
        self._conversations = count()

    def __iter__(self) -> Iterator[PeerState]:
        return iter(list(self._states.values()))

    def get(self, address: Hashable) -> PeerState | None:
        """Return the peer at an address."""
        return self._states.get(address)

    def add_fixed(self, address: Hashable) -> None:
        """Give the address that the user named a place for good."""
        self._states[address] = self._new(address, 0.0, fixed=True)

    def admit(self, address: Hashable, frames: Iterable[Frame], now: float) -> PeerState | None:
        """Make room for a new address: a free place, or that of a silent peer or one without HEARTBEAT."""
        reserved = self._is_reserved(frames)
        if len(self._states) >= self._places + (RESERVED_PLACES if reserved else 0):
            leaving = min(
                (each for each in self._states.values() if not each.fixed and self._is_evictable(each, now)),
                key=lambda each: each.last_seen,
                default=None,
            )
            if leaving is None:
                self.refused += 1
                return None
            self.forget(leaving)
        state = self._states[address] = self._new(address, now)
        state.connected = state.silent = self._stream
        return state

    def admit_transient(self, address: Hashable, now: float) -> PeerState:
        """Remember the sender of a stop for whom there is no place."""
        if self.transient is None or self.transient.peer.address != address:
            self.transient = self._new(address, now)
        return self.transient

    def end_connection(self, address: Hashable) -> None:
        """Forget the peer whose connection has ended; a fixed one begins a new conversation."""
        state = self._states.get(address)
        if state is None:
            return
        self.forget(state)
        if state.fixed:
            successor = self._states[address] = self._new(address, state.last_seen, fixed=True)
            successor.sequence = state.sequence

    def forget(self, state: PeerState) -> None:
        """Remove a peer; its counts are kept."""
        del self._states[state.peer.address]
        self.past_counts.add(state.framer.counts)

    def expire(self, now: float) -> None:
        """Drop peers that have been silent for PEER_SILENCE.

        The peer that the user named and connections stay, and begin a new conversation.
        """
        for state in self:
            if state.silent or now - state.last_seen <= PEER_SILENCE:
                continue
            if state.is_expected:
                state.peer, state.silent = self._new_conversation(state.peer.address), True
            else:
                self.forget(state)

    def known(self, peers: Iterable[Peer]) -> list[PeerState]:
        """Return those of `peers` on this link whose conversation is still the same."""
        found: list[PeerState] = []
        for peer in peers:
            if peer.link == self._index:
                places = (self._states.get(peer.address), self.transient)
                found += [state for state in places if state is not None and state.peer == peer]
        return found

    def recipients(self, outgoing: Outgoing) -> list[PeerState]:
        """Return the peers to which a message goes."""
        message, peer, among = outgoing
        if type(message).id in LOG_ONLY:
            return []
        if peer is not None:
            return self.known((peer,))
        if among is not None:
            return self.known(among)
        target = target_system(message)
        return [state for state in self if state.accepts_target(target)]

    def _is_reserved(self, frames: Iterable[Frame]) -> bool:
        """Return whether a frame has the ids for which places are kept."""
        return any((each[1], each[2]) == self.reserved_ids for each in frames)

    def _is_evictable(self, state: PeerState, now: float) -> bool:
        return not state.systems or now - state.last_seen > PEER_SILENCE

    def _new(self, address: Hashable, now: float, *, fixed: bool = False) -> PeerState:
        peer, framer = self._new_conversation(address), Framer(stream=self._stream)
        return PeerState(peer, framer, now, fixed, silent=fixed, sequence=self._first_sequence)

    def _new_conversation(self, address: Hashable) -> Peer:
        return Peer(self._index, address, next(self._conversations), _name(address) if self._named else "")


def _name(address: Hashable) -> str:
    """Return the name of a program in its fleet; "" for a text that is no name, which may hold anything."""
    text = str(address)
    return text if re.fullmatch(FLEET_NAME, text) else ""
