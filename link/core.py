"""The one contract of both houses: a core takes messages and time, and gives messages. Shells do the I/O."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

from dialects.messages import Message


class Peer(NamedTuple):
    """The other end of a link in one conversation: which link, which address on it, and which of its conversations.

    Who was gone and comes back is another peer, so that nothing of the first sticks to the second.
    """

    link: int
    address: Hashable
    conversation: int = 0
    """Counted over all addresses of the link."""


RECORDER = Peer(-1, "recorder")
"""The log, which hears all that there is, also where nobody else listens; no link leads there."""


class Received(NamedTuple):
    """A message that was found whole, checked and counted."""

    message: Message
    system: int
    """System id of the sender, 1..255."""
    component: int
    """Component id of the sender, 1..255."""
    sequence: int
    """Packet sequence number, 0..255."""
    peer: Peer
    introduced: bool
    """The peer has shown a HEARTBEAT of this system: only then may it control (a moved address must say who it is)."""
    named: bool = False
    """The user named this peer's address, as in `udpout`, or it has connected to us: what goes there goes nowhere
    unasked."""

    @property
    def may_ask(self) -> bool:
        """May it have answers longer than its questions? MAVSDK asks before its first HEARTBEAT."""
        return self.introduced or self.named


class Outgoing(NamedTuple):
    """A message to send: to one peer, or to some, or where neither is named to every peer that it is meant for."""

    message: Message
    peer: Peer | None = None
    among: tuple[Peer, ...] | None = None
    """These peers, on whichever links they are; it is encoded once."""


@dataclass(frozen=True, slots=True)
class SourceCount:
    """What one system and component has got through, since the link opened."""

    received: int
    lost: int


@dataclass(frozen=True, slots=True)
class LinkReport:
    """What a link says of itself, counted since it opened."""

    name: str
    """The endpoint as the user wrote it."""
    index: int = 0
    peers: int = 0
    frames: int = 0
    bytes_received: int = 0
    crc_errors: int = 0
    resync_bytes: int = 0
    unknown: int = 0
    """Frames with an id that the dialect lacks."""
    duplicates: int = 0
    late: int = 0
    rate_limited: int = 0
    refused_peers: int = 0
    dialect_mismatch: tuple[str, ...] = ()
    """Names of messages that arrive whole but with another definition's checksum."""
    own_id: bool = False
    """Somebody else sends with our system and component id."""
    down: str | None = None
    """Why the link is down, or None."""
    capacity: float | None = None
    """What the wire takes, bytes/s; None where nobody knows (UDP, TCP). All telemetry together belongs well below."""
    headroom: float = 1.0
    """Share of the capacity that may be filled now, 0..1: a telemetry radio asks for less (RADIO_STATUS)."""
    dropped: int = 0
    """Frames of ours that the link had no room for."""
    sources: dict[tuple[int, int], SourceCount] = field(default_factory=dict)
    audience: tuple[Peer, ...] = ()
    """Who gets what is for everybody: who has shown a HEARTBEAT, or connected, and the address that the user named."""


class Core(Protocol):
    """What the runner drives. `now` is seconds of a monotonic clock and never goes back.

    Two rules of the content: state (demands, telemetry, heartbeats) is replaced, the newest wins; commands are repeated
    until acknowledged. And silence is an input: tick() acts on what did not arrive.
    """

    def receive(self, received: Received, now: float) -> None:
        """Take one message and act on it at once."""

    def tick(self, now: float) -> None:
        """Let time pass: send what is due, act on what is overdue."""

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Take what the links say of themselves, about once a second."""

    def messages_to_send(self) -> list[Outgoing]:
        """What to send now; empties what it returns."""
