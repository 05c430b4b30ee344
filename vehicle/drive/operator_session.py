"""Operator sessions: demands that carry the proof of their own age (ROVER_OPERATOR_PRESENCE with axes).

A session is one run of a ground station, named by a random number. Each of its demands echoes the newest time of this
vehicle that it has seen, so that its age is known without synchronised clocks, and over any mix of links: a copy, a
late frame of a second link and a frame of another program with the same system id move nothing.
"""

from __future__ import annotations

import math
from enum import Enum, auto
from typing import NamedTuple

import msgspec

from dialects.enums import OperatorFlag
from dialects.messages import RoverOperatorPresence, boot_ms
from vehicle.drive.conversation import Conversation

PROOF_VALID = 1.0
"""s for which a good proof names the session of its sender: when it takes control, and when it sends a command."""
SENDERS_MAX = 16
"""Senders whose newest proof is remembered."""
LINK_MEMORY = 30.0
"""s for which a link that has fallen silent is still known as one of a session: as long as a file stays open."""
LINKS_MAX = 8
"""Conversations of one session that are remembered."""

_WRAP = 2**32


class Proof(NamedTuple):
    """What one ROVER_OPERATOR_PRESENCE with axes proves."""

    session: int
    clock: int
    """`time_boot_ms` of the sender: the order of the demands of one session."""
    age: float
    """s since the vehicle time that the sender had seen; infinite if it has seen none."""


class DemandOrder(Enum):
    """What a proof of the driver's own session is, compared with the one in use."""

    NEWEST = auto()
    NOT_NEWER = auto()
    """A copy, or overtaken on a slower link."""


def parse_proof(message: RoverOperatorPresence, since_boot: float) -> Proof | None:
    """Return the proof in a message; None if it carries no axes, as from older ground stations."""
    if not message.flags & OperatorFlag.AXES:
        return None
    return Proof(message.session_id, message.time_boot_ms, echo_age(message.echo_time_boot_ms, since_boot))


def echo_age(echo: int, since_boot: float) -> float:
    """Return the age of the echoed boot time in s; infinite if the sender has seen none.

    The echo of a former boot seems to be from the future and comes out as weeks old.
    """
    return ((boot_ms(since_boot) - echo) % _WRAP) / 1000 if echo else math.inf


class SessionLink(NamedTuple):
    """A conversation of the driver's session."""

    proven_at: float
    """When its newest good proof arrived; -infinity if it has brought late ones only."""
    age: float
    """s: age of the newest proof on arrival, good or not."""


class DrivingSession(msgspec.Struct):
    """The session of the ground station in control."""

    id: int
    clock: int | None = None
    """`time_boot_ms` of its newest demand; None before the first."""
    links: dict[Conversation, SessionLink] = msgspec.field(default_factory=dict)
    """The conversations that have brought proofs of this session: over several links, or from another address."""

    @classmethod
    def begin(cls, conversation: Conversation, proof: Proof, at: float) -> DrivingSession:
        """Return the session of a good proof that arrived at `at`."""
        return cls(proof.session, links={conversation: SessionLink(at, proof.age)})

    def order(self, proof: Proof) -> DemandOrder:
        """Compare a proof with the newest one so far. Clocks wrap after 49 days."""
        if self.clock is None or 0 < (proof.clock - self.clock) % _WRAP < _WRAP // 2:
            return DemandOrder.NEWEST
        return DemandOrder.NOT_NEWER

    def add_proof(self, conversation: Conversation, proof: Proof, now: float, *, good: bool) -> None:
        """Note a proof of this session; of too many conversations the one that was proven longest ago is forgotten."""
        before = self.links.pop(conversation, None)
        proven_at = now if good else before.proven_at if before else -math.inf
        self.links[conversation] = SessionLink(proven_at, proof.age)
        if len(self.links) > LINKS_MAX:
            del self.links[min(self.links, key=lambda each: self.links[each].proven_at)]

    def is_proven(self, conversation: Conversation, now: float) -> bool:
        """Return whether a conversation has brought a good proof within PROOF_VALID."""
        return conversation in self.links and now - self.links[conversation].proven_at <= PROOF_VALID

    def setpoint_age(self, conversation: Conversation, now: float) -> float:
        """Return the s since the vehicle time that is proven for a conversation, a bound of the age of its setpoints.

        Infinite without a good proof.
        """
        link = self.links.get(conversation)
        return math.inf if link is None else now - link.proven_at + link.age


class RecentProofs:
    """The newest good proof of each sender, for the moment in which one takes control."""

    def __init__(self) -> None:
        self._newest: dict[Conversation, tuple[Proof, float]] = {}

    def add(self, conversation: Conversation, proof: Proof, now: float) -> None:
        """Remember a good proof; of too many senders the one that was added first is forgotten."""
        self._newest.pop(conversation, None)
        self._newest[conversation] = (proof, now)
        if len(self._newest) > SENDERS_MAX:
            del self._newest[next(iter(self._newest))]

    def session_of(self, conversation: Conversation, now: float) -> DrivingSession | None:
        """Return the session that a sender has proven within PROOF_VALID, with its other links, or None."""
        proof, at = self._newest.get(conversation, (None, -math.inf))
        if proof is None or now - at > PROOF_VALID:
            return None
        session = DrivingSession.begin(conversation, proof, at)
        for other, (theirs, proven_at) in self._newest.items():
            is_link = other != conversation and other.ids == conversation.ids and theirs.session == proof.session
            if is_link and len(session.links) < LINKS_MAX:
                session.add_proof(other, theirs, proven_at, good=True)
        return session

    def links_of(self, conversation: Conversation, now: float) -> list[Conversation]:
        """Return the other conversations that have proven the session of a sender, also those that are silent."""
        proof, at = self._newest.get(conversation, (None, -math.inf))
        if proof is None or now - at > LINK_MEMORY:
            return []
        return [
            other
            for other, (theirs, proven_at) in self._newest.items()
            if other != conversation
            and other.ids == conversation.ids
            and theirs.session == proof.session
            and now - proven_at <= LINK_MEMORY
        ]
