"""The peers of a channel: who has a place, who gives it up, and which conversation each is in.

When all places are taken, a newcomer gets that of a peer that is silent or has sent no HEARTBEAT; then that of a peer
of a lower rank (Rank); then one of an owner with more than its share. An owner is a key, an operator of a fleet, or, of
what is not signed, the host of the address: that can be forged, and so a host keeps OWNER_PLACES. Who has lost a place
in this way cannot take it back in the same way, so that places do not change hands for ever. The ground station in
control loses none: its ids keep as many places as are reserved for them.
"""

from __future__ import annotations

import re
from collections import Counter, deque
from collections.abc import Hashable, Iterable, Iterator
from enum import IntEnum
from itertools import count
from typing import TYPE_CHECKING

from dialects.messages import target_system
from dialects.traits import COMMANDS, LOG_ONLY, is_stop
from link.core import Outgoing, Peer
from link.endpoint import FLEET_NAME
from link.protocol.address_budget import AddressBudget
from link.protocol.frame import Frame, FramerCounts
from link.protocol.framer import Framer
from link.protocol.peer import PeerState
from link.signing.role import SigningRole

if TYPE_CHECKING:
    from link.signing.keys import SigningKey

MAX_PEERS = 24
"""Sixteen ground stations on one port, and room for half of them to restart: a restarted program has a new port, and
its old place is not free before PEER_SILENCE. More cost little: their tables are bounded, and what the vehicle streams
to all peers of a link has one budget (vehicle/telemetry/telemetry.py)."""
RESERVED_PLACES = 4
"""Further places for the ids of the ground station in control: it may come from another address when all others are
taken."""
PEER_SILENCE = 10.0
"""s without a frame after which a peer gives up its place; twice the longest usual heartbeat timeout."""
OWNER_PLACES = 4
"""Places of one operator of a fleet: a station, and verbs beside it. Also those that a host of unsigned peers keeps
when others need them."""
RUN_SILENCE = 1.5
"""s without a frame after which a run of an operator leaves its place to the operator's next one: a HEARTBEAT is
missing. Below that five programs that run at once would take turns."""


ANSWERED_MAX = 32
"""Senders whose time was refused, and who are answered."""


class Rank(IntEnum):
    """Whose place is kept when there are not enough."""

    UNSIGNED = 0
    WATCH = 1
    """Signed with a key that may watch."""
    DRIVE = 2
    """Signed with a key that may drive, or set up."""


def rank_of(key: SigningKey | None) -> Rank:
    """Return the rank of a peer whose newest verified frame was signed with `key`; None: it has sent none."""
    if key is None:
        return Rank.UNSIGNED
    return Rank.WATCH if key.role is SigningRole.WATCH else Rank.DRIVE


class PeerTable:
    """The peers of link `index` by address, at most `places`. `stream`: bytes have no datagram boundaries.

    `first_sequence` is the packet sequence, 0..255, of the first frame to each peer. `named`: an address is the name of
    its program.
    """

    def __init__(
        self,
        index: int,
        *,
        stream: bool,
        places: int,
        first_sequence: int,
        named: bool,
        bounded: bool,
    ) -> None:
        self.past_counts = FramerCounts()
        """Of the peers that have gone."""
        self.refused = 0
        """Datagrams of senders for whom there was no place."""
        self.reserved_ids: tuple[int, int] | None = None
        """System and component id for which places are kept."""
        self.transient: PeerState | None = None
        """The newest sender of a stop for whom there was no place, so that the stop can be acknowledged."""
        self.untimely: deque[PeerState] = deque(maxlen=ANSWERED_MAX)
        """The newest senders without a place whose time was refused, so that they can be answered."""
        self._index = index
        self._stream = stream
        self._places = places
        self._first_sequence = first_sequence
        self._named = named
        self._bounded = bounded and not stream  # a connection proves its address
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

    def admit(
        self, address: Hashable, frames: Iterable[Frame], now: float, key: SigningKey | None = None
    ) -> PeerState | None:
        """Make room for a new address, as the module says; None: there is none. `key`: of its verified frames."""
        reserved = self._is_reserved(frames)
        if len(self._states) >= self._places + (RESERVED_PLACES if reserved else 0):
            leaving = self._find_leaving(rank_of(key), self._owner(address, key), now)
        elif self._named and self._count_runs(address) >= OWNER_PLACES:
            leaving = self._find_run(address, now)
        else:
            return self._add(address, now)
        if leaving is None:
            self.refused += 1
            return None
        self.forget(leaving)
        return self._add(address, now)

    def admit_transient(self, address: Hashable, now: float) -> PeerState:
        """Remember the sender of a stop for whom there is no place."""
        if self.transient is None or self.transient.peer.address != address:
            self.transient = self._new(address, now)
        return self.transient

    def admit_untimely(self, address: Hashable, now: float) -> PeerState:
        """Remember the sender of a frame whose time was refused."""
        known = next((each for each in self.untimely if each.peer.address == address), None)
        if known is None:
            known = self._new(address, now)
            self.untimely.append(known)
        return known

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
                places = (self._states.get(peer.address), self.transient, *self.untimely)
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
        if type(message).id in COMMANDS and is_stop(message):
            return list(self)  # also who was not heard as a vehicle: the vehicle behind it may have no place for us
        target = target_system(message)
        return [state for state in self if state.accepts_target(target)]

    def _is_reserved(self, frames: Iterable[Frame]) -> bool:
        """Return whether a frame has the ids for which places are kept."""
        return any((each[1], each[2]) == self.reserved_ids for each in frames)

    def _add(self, address: Hashable, now: float) -> PeerState:
        state = self._states[address] = self._new(address, now)
        state.connected = state.silent = self._stream
        return state

    def _count_runs(self, address: Hashable) -> int:
        """Return how many places the operator of this address has."""
        source = self._source(address)
        return sum(each.source == source for each in self._states.values())

    def _find_run(self, address: Hashable, now: float) -> PeerState | None:
        """Return the run of an operator that leaves its place to another one of the same operator."""
        source = self._source(address)
        runs = [each for each in self._states.values() if each.source == source and not each.fixed]
        leaving = [each for each in runs if not each.systems or now - each.last_seen > RUN_SILENCE]
        return min(leaving, key=lambda each: each.last_seen, default=None)

    def _find_leaving(self, rank: Rank, owner: Hashable, now: float) -> PeerState | None:
        """Return the peer that leaves its place to a newcomer."""
        peers = [each for each in self._states.values() if not each.fixed]
        absent = [each for each in peers if self._is_evictable(each, rank, now)]
        if absent:
            return min(absent, key=lambda each: each.last_seen)
        held = [each for each in peers if self.reserved_ids in each.sources]
        if len(held) <= RESERVED_PLACES:
            peers = [each for each in peers if self.reserved_ids not in each.sources]
        places = Counter([each.owner for each in peers])
        leaving = [each for each in peers if rank_of(each.key) < rank] if rank else []
        return min(
            leaving or self._find_rich(peers, rank, places, places[owner] + 2),
            key=lambda each: (rank_of(each.key), -places[each.owner], each.last_seen),
            default=None,
        )

    def _find_rich(self, peers: list[PeerState], rank: Rank, places: Counter[Hashable], least: int) -> list[PeerState]:
        """Return the peers of a rank whose owners have at least `least` places, and more than they may keep."""
        if rank is Rank.UNSIGNED and not self._named:
            least = max(least, OWNER_PLACES + 1)
        rich = {owner for owner, count in places.items() if count >= least}
        return [each for each in peers if each.owner in rich and rank_of(each.key) == rank] if rich else []

    def _owner(self, address: Hashable, key: SigningKey | None) -> Hashable:
        return self._source(address) if key is None else key

    def _source(self, address: Hashable) -> Hashable:
        """Return whose address this is: the operator of a run, as of "alice/3f2a", or the host."""
        if self._named:
            return str(address).partition("/")[0]
        return address[0] if isinstance(address, tuple) else address

    def _is_evictable(self, state: PeerState, rank: Rank, now: float) -> bool:
        """Return whether a peer leaves its place to any newcomer of this rank."""
        return now - state.last_seen > PEER_SILENCE or (not state.systems and rank_of(state.key) <= rank)

    def _new(self, address: Hashable, now: float, *, fixed: bool = False) -> PeerState:
        peer, framer = self._new_conversation(address), Framer(stream=self._stream)
        return PeerState(
            peer,
            framer,
            now,
            fixed,
            silent=fixed,
            sequence=self._first_sequence,
            budget=AddressBudget() if self._bounded and not fixed else None,
            source=self._source(address),
        )

    def _new_conversation(self, address: Hashable) -> Peer:
        return Peer(self._index, address, next(self._conversations), _name(address) if self._named else "")


def _name(address: Hashable) -> str:
    """Return the name of a program in its fleet; "" for a text that is not a name, which may hold anything."""
    text = str(address)
    return text if re.fullmatch(FLEET_NAME, text) else ""
