"""What a channel knows of one address: who is behind it, how its frames are numbered, how much it may send."""

from __future__ import annotations

from dataclasses import dataclass, field

from link.core import Peer
from link.protocol.frame import Frame
from link.protocol.framer import Framer
from link.protocol.rate import TokenBucket
from link.protocol.sequence import FrameOrder, SequenceTracker

MAX_SOURCES = 64
"""Systems and components counted behind one peer."""


def _buckets() -> dict[str, TokenBucket]:
    # Demands come at 50 Hz at most. Commands come by hand, and from scripts that ask for the rates of all messages at
    # once; more than these would take a whole control cycle. The rest has room for ArduPilot's 1240 messages/s.
    return {"demand": TokenBucket(200, 50), "command": TokenBucket(200, 100), "rest": TokenBucket(2500, 1000)}


@dataclass(slots=True)
class PeerState:
    """What we know of one address."""

    peer: Peer
    framer: Framer
    last_heard: float
    fixed: bool = False
    """The user named this address: it is sent to before it has spoken."""
    connected: bool = False
    """A connection that somebody made: it is sent to before it has spoken, too, while it lasts."""
    silent: bool = False
    """It has not spoken yet in this conversation; only one that the user named is kept all the same."""
    sequence: int = 0
    systems: set[int] = field(default_factory=set)
    """Systems whose HEARTBEAT came from here."""
    sources: dict[tuple[int, int], SequenceTracker] = field(default_factory=dict)
    buckets: dict[str, TokenBucket] = field(default_factory=_buckets)

    @property
    def is_expected(self) -> bool:
        """Does somebody wait for what we say, though he has said nothing himself?"""
        return self.fixed or self.connected

    def accepts_target(self, target: int) -> bool:
        """Should a message for system `target` (0: for all) go here?"""
        if not self.systems:
            return self.is_expected
        return target == 0 or target in self.systems

    def add_source(self, frame: Frame) -> FrameOrder:
        """The first frame of a source that is new here; of too many sources no numbers are kept."""
        if len(self.sources) < MAX_SOURCES:
            message_id, system, component, sequence, _ = frame
            self.sources[system, component] = SequenceTracker(sequence, message_id)
        return FrameOrder.NEW
