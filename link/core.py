"""Interface between sans-IO cores, which take messages and time, and the runner that drives them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from typing import NamedTuple, Protocol, runtime_checkable

import msgspec

from dialects.messages import Message
from link.signing.role import SigningRole


class Peer(NamedTuple):
    """The other end of a link in one conversation: link index, address on it, conversation number.

    A program that restarts at the same address is another peer, so that no state of the first applies to the second.
    """

    link: int
    address: Hashable
    conversation: int = 0
    """Counted over all addresses of the link."""
    name: str = ""
    """What the program there is called in its fleet; "" on links without names."""


RECORDER = Peer(-1, "recorder")
"""The log, which gets all telemetry even without any other peer; no link leads there."""


class Received(NamedTuple):
    """A message whose frame was complete, verified and counted."""

    message: Message
    system: int
    """System id of the sender, 1..255."""
    component: int
    """Component id of the sender, 1..255."""
    sequence: int
    """Packet sequence number, 0..255."""
    peer: Peer
    introduced: bool
    """The peer has sent a HEARTBEAT of this system; only then may it control. An address that changed must send it
    again."""
    named: bool = False
    """The user gave this peer's address, as in `udpout`, or the peer has connected to us: replies reach no third
    party."""
    numbering: int = 0
    """Which run of packet numbers of this sender at this peer (link/protocol/sequence.py); 0: not known."""
    clash: bool = False
    """Another program counts in the same run, with the same ids and at the same peer."""
    digest: int = 0
    """Equal for frames that are equal byte for byte; 0: not known."""
    role: SigningRole = SigningRole.SET_UP
    """What the sender may do: the role of the key that signed the frame, or what the link grants unsigned frames."""
    signed: bool = False
    """The frame carried a signature, and it was verified."""

    @property
    def may_ask(self) -> bool:
        """Whether replies may be longer than the request. MAVSDK sends requests before its first HEARTBEAT."""
        return self.introduced or self.named


class Outgoing(NamedTuple):
    """A message to send: to one peer, to several, or (neither given) to every peer that it concerns."""

    message: Message
    peer: Peer | None = None
    among: tuple[Peer, ...] | None = None
    """Several peers, on any links; the message is encoded once."""


class AddressPair(NamedTuple):
    """Between which addresses the frames of a peer go: peers with one local address share a network."""

    local: str
    """Address of this machine."""
    host: str
    """Address of the other end, without its port."""


OtherPeers = Callable[[Received, float], Iterable[Peer]]
"""Returns where else the sender of a message is at a time, s: on other links of the same program."""


class SourceCount(msgspec.Struct, frozen=True):
    """Frames of one system and component since the link opened."""

    received: int
    lost: int


class SigningCounts(msgspec.Struct, frozen=True):
    """Frames that were refused for want of a good signature; the counters run since the link opened."""

    bad: int = 0
    """Made with no known key, or changed on the way."""
    replayed: int = 0
    """Not newer than those before them."""
    unsigned: int = 0
    """Without a signature where one is required."""
    too_old: int = 0
    """The first of their stream and more than a minute behind our clock, or more than a day ahead of the right time."""


class GuardReport(msgspec.Struct, frozen=True):
    """What is known of signing on a link that verifies."""

    key: str
    """Name and fingerprint of the key that signs what goes to everybody; empty without a key."""
    refused: Mapping[int, SigningCounts] = msgspec.field(default_factory=dict)
    """System id that a refused frame names -> how many. It may be anybody's: nothing of these frames is proven."""
    behind: Mapping[int, float] = msgspec.field(default_factory=dict)
    """System id -> s by which the clock of its newest late frame was behind ours. The frame was genuine."""
    ahead: Mapping[int, float] = msgspec.field(default_factory=dict)
    """System id -> s by which its signing clock is ahead of ours."""


class LinkReport(msgspec.Struct, frozen=True):
    """State of a link; counters run since the link opened."""

    name: str
    """The endpoint as the user wrote it."""
    index: int = 0
    peers: int = 0
    frames: int = 0
    bytes_received: int = 0
    crc_errors: int = 0
    resync_bytes: int = 0
    unknown: int = 0
    """Frames with an id outside the dialect."""
    duplicates: int = 0
    late: int = 0
    rate_limited: int = 0
    refused_peers: int = 0
    unknown_ids: dict[tuple[int, int, int], tuple[int, int]] = msgspec.field(default_factory=dict)
    """Of those, by system, component and id: frames, and bytes of the newest one. At most 64, and not verified."""
    dialect_mismatch: tuple[str, ...] = ()
    """Names of messages that arrive complete but with the checksum of another definition."""
    signing: frozenset[int] = frozenset()
    """System ids whose newest frame was signed."""
    verified: frozenset[int] = frozenset()
    """Those of them whose signature was verified with a key of ours."""
    refused: SigningCounts | None = None
    """None: this link verifies no signatures."""
    guard: GuardReport | None = None
    """The same."""
    own_id: bool = False
    """Another program sends with our system and component id."""
    version_1: frozenset[int] = frozenset()
    """System ids that have sent MAVLink 1 only, and are answered in it."""
    down: str | None = None
    """Why the link is down, or None."""
    capacity: float | None = None
    """Bytes/s that the link carries; None where unknown (UDP, TCP). All telemetry together must stay well below."""
    routes: Mapping[Peer, AddressPair] = msgspec.field(default_factory=dict)
    """Of the first peers that sent a HEARTBEAT; none of serial ports."""
    headroom: float = 1.0
    """Share of the capacity that may be used now, 0..1; RADIO_STATUS of a telemetry radio reduces it."""
    dropped: int = 0
    """Outgoing frames dropped because the link had no room."""
    frames_sent: int = 0
    """Outgoing frames, forwarded and dropped ones included, like `bytes_sent`."""
    bytes_sent: int = 0
    watch_only: bool = False
    """Nothing is ever sent on it."""
    retry_in: float | None = None
    """s until the next attempt to open it; None while it is open."""
    sources: dict[tuple[int, int], SourceCount] = msgspec.field(default_factory=dict)
    audience: tuple[Peer, ...] = ()
    """Peers that get broadcast messages: those that sent a HEARTBEAT or connected, and the address that the user
    named."""


class Core(Protocol):
    """What the runner drives. `now` is s of a monotonic clock and never goes back.

    State (demands, telemetry, heartbeats) is replaced, the newest wins; commands are repeated until acknowledged.
    Silence is an input as well: tick() acts on what did not arrive.
    """

    def receive(self, received: Received, now: float) -> None:
        """Handle one message at once."""

    def tick(self, now: float) -> None:
        """Advance to `now`: send what is due, act on what is overdue."""

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Store the state of all links, about once a second."""

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them."""


@runtime_checkable
class EarlyActor(Protocol):
    """A core that may have something to do before its next tick, and too soon for a tick of everything."""

    @property
    def due_at(self) -> float | None:
        """When `act` is to be called; None: not before the next tick, after which it is asked again."""

    def act(self, now: float) -> None:
        """Do it; the messages are sent as after a tick."""


@runtime_checkable
class PeerReservation(Protocol):
    """A core that is controlled by one peer, for which each link keeps places."""

    @property
    def reserved_ids(self) -> tuple[int, int] | None:
        """System and component id of the ground station in control, or None."""


@runtime_checkable
class TimeTeller(Protocol):
    """A core that answers senders who sign with a wrong time, so that they learn the right one."""

    def tell_time(self, peer: Peer, now: float) -> None:
        """Send one HEARTBEAT to a sender whose frames are genuine and not accepted."""


@runtime_checkable
class CopyFinder(Protocol):
    """A core that finds out what a second link only repeats: after it nothing needs to be sent."""

    @property
    def repeats(self) -> bool:
        """Whether the newest message was a copy of what another link has brought, and has changed nothing."""


@runtime_checkable
class RestingCore(Protocol):
    """A core that has nothing to do for some time."""

    @property
    def rest_period(self) -> float | None:
        """Time between ticks, s, that is enough until the next message or `Runner.flush`; then it is asked again.

        None: it needs all ticks.
        """


@runtime_checkable
class Onlooker(Protocol):
    """A core that looks at some vehicles only; of others a little telemetry is enough, where a link can choose."""

    @property
    def interesting_systems(self) -> frozenset[int] | None:
        """System ids of the vehicles that it looks at; None: all."""


@runtime_checkable
class SendListener(Protocol):
    """A core that needs the packet sequence of the messages it sent."""

    def handle_sent(self, message: Message, sequence: int, now: float) -> None:
        """Note the sequence under which `message` was sent."""


@runtime_checkable
class RefusalListener(Protocol):
    """A core that wants to know which of its messages are not sent because its role does not allow them."""

    def handle_refused(self, message: Message, why: str, now: float) -> None:
        """Note that a link did not send `message`; `why` is one line for the user."""


@runtime_checkable
class SendGuard(Protocol):
    """A core that can withdraw a message in the last moment, e.g. after the process was stopped and goes on."""

    def may_send(self, message: Message, now: float) -> bool:
        """Return whether `message` may still be sent."""
