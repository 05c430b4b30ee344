"""State of one address on a channel: systems behind it, sequence numbers, rate limits."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import TYPE_CHECKING

import msgspec

from dialects.codec import MAGIC_V2
from dialects.messages import Heartbeat
from link.core import Peer, SourceCount
from link.protocol.address_budget import AddressBudget
from link.protocol.frame import Frame
from link.protocol.framer import Framer
from link.protocol.rate import TokenBucket
from link.protocol.sequence import SequenceTracker
from link.signing.signature import is_signed

if TYPE_CHECKING:  # a verb through a station needs no keys
    from link.signing.keys import SigningKey

MAX_ID_V1 = 255
"""Largest message id of a MAVLink 1 frame."""
ONE, TWO, BOTH = (1,), (2,), (2, 1)
"""Versions of the frames of one message."""

MAX_SOURCES = 64
"""Systems and components tracked behind one peer."""


FILE_RATE, FILE_BURST = 14_000, 2_000
"""Frames/s of files that a ground station accepts, and at once; it has requested them."""


def _buckets() -> dict[str, TokenBucket]:
    # Demands come at 50 Hz at most. Commands come from people, and from scripts that request the rates of all messages
    # at once; more than these would take a whole control cycle. The rest has room for ArduPilot's 1240 messages/s.
    return {
        "demand": TokenBucket(200, 50),
        "command": TokenBucket(200, 100),
        "file": TokenBucket(FILE_RATE, FILE_BURST),
        "rest": TokenBucket(2500, 1000),
    }


class PeerState(msgspec.Struct):
    """State of one address."""

    peer: Peer
    framer: Framer
    last_seen: float
    fixed: bool = False
    """The user named this address: it is sent to before its first frame."""
    connected: bool = False
    """A connection: it is sent to before its first frame as well, while it lasts."""
    silent: bool = False
    """No frame yet in this conversation; such a peer is kept only if it is fixed or connected."""
    sequence: int = 0
    systems: set[int] = msgspec.field(default_factory=set)
    """Systems whose HEARTBEAT came from this address."""
    sources: dict[tuple[int, int], SequenceTracker] = msgspec.field(default_factory=dict)
    modern: set[int] = msgspec.field(default_factory=set)
    """Systems of which a MAVLink 2 frame came from this address."""
    newest: dict[int, bytes] = msgspec.field(default_factory=dict)
    """Newest frame of each system, as received."""
    buckets: dict[str, TokenBucket] = msgspec.field(default_factory=_buckets)
    key: SigningKey | None = None
    """The key of its newest signed frame, with which ours to it are signed."""
    budget: AddressBudget | None = None
    """What may be sent before the address has shown that it receives; None: no limit."""
    source: Hashable = None
    """Whose address it is: the name of an operator of a fleet, or a host."""
    clocks: dict[SigningKey, float] = msgspec.field(default_factory=dict)
    """Key -> the largest difference of the timestamps that it has signed here to the monotonic clock, in timestamps of
    10 us. Kept by key: behind a bridge, and behind a forged address, the clock of one key is not that of another."""

    @property
    def owner(self) -> Hashable:
        """Who has this place: the holder of a key, or whose address it is."""
        return self.source if self.key is None else self.key

    @property
    def is_expected(self) -> bool:
        """Whether the peer is sent to before its first frame."""
        return self.fixed or self.connected

    def note_frame(self, system: int, raw: bytes) -> None:
        """Keep the newest frame of a system, and whether it knows MAVLink 2."""
        self.newest[system] = raw
        if raw[0] == MAGIC_V2:
            self.modern.add(system)

    @property
    def is_modern(self) -> bool:
        """Whether all systems behind this address have sent MAVLink 2."""
        return len(self.modern) == len(self.newest)

    def versions(self, number: int, target: int) -> tuple[int, ...]:
        """Return the MAVLink versions in which a message for system `target` (0: all) goes to this peer.

        A system that has sent version 1 only is answered in it (https://mavlink.io/en/guide/mavlink_version.html). Its
        HEARTBEAT goes in both: ArduPilot changes to version 2 with the first frame of that version.
        """
        if self.is_modern or number > MAX_ID_V1 or target in self.modern:
            return TWO
        if target:
            return ONE if target in self.newest else TWO
        return BOTH if self.modern or number == Heartbeat.id else ONE

    def accepts_target(self, target: int) -> bool:
        """Return whether a message for system `target` (0: all) goes to this peer."""
        if not self.systems:
            return self.is_expected
        return target == 0 or target in self.systems

    def add_source(self, frame: Frame, digest: int, now: float) -> SequenceTracker | None:
        """Track a new source from its first frame; with too many sources no numbers are kept."""
        if len(self.sources) >= MAX_SOURCES:
            return None
        message_id, system, component, sequence, _ = frame
        source = self.sources[system, component] = SequenceTracker(sequence, message_id, digest, now)
        return source


def count_sources(states: Iterable[PeerState]) -> dict[tuple[int, int], SourceCount]:
    """Return the frames of each system and component, over all peers."""
    totals: dict[tuple[int, int], SourceCount] = {}
    for state in states:
        for key, source in state.sources.items():
            before = totals.get(key, SourceCount(0, 0))
            totals[key] = SourceCount(before.received + source.received, before.lost + source.lost)
    return totals


def find_version_1(states: Iterable[PeerState]) -> frozenset[int]:
    """Return the systems that have sent MAVLink 1 only, wherever they were heard."""
    states = list(states)
    heard = {system for state in states for system in state.newest}
    return frozenset(heard.difference(*(state.modern for state in states)))


def find_signing(states: Iterable[PeerState]) -> frozenset[int]:
    """Return the systems whose newest frame was signed."""
    return frozenset(system for state in states for system, raw in state.newest.items() if is_signed(raw))
