"""Operator sessions: demands that carry the proof of their own age (ROVER_OPERATOR_PRESENCE with axes).

A session is one run of a ground station, named by a random number. Each of its demands echoes the newest time of this
vehicle that it has seen, so that its age is known without synchronised clocks, and over any mix of links: a copy, a
late frame of a second link and a frame of another program with the same system id move nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum, auto
from typing import NamedTuple

from dialects.enums import OperatorFlag
from dialects.messages import RoverOperatorPresence, boot_ms
from link.core import Peer, Received

SUCCESSION_TIME = 0.7
"""s without a proof of the driver's session after which another session with its system id takes over. Longer than
OPR_ECHO_MAX and one interval at 5 Hz, so that two idle programs do not take turns at 10 % loss; below 1 s, so that a
restarted ground station drives again within 1 s."""
PROOF_VALID = 1.0
"""s for which a proof names the session of the sender who then takes control."""
SOURCES_MAX = 16
"""Senders whose newest proof is remembered."""

_WRAP = 2**32


class Source(NamedTuple):
    """The sender of a message: system, component, and the peer that it arrived from."""

    system: int
    component: int
    peer: Peer

    @classmethod
    def of(cls, received: Received) -> Source:
        """Return the sender of a message."""
        return cls(received.system, received.component, received.peer)


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


@dataclass(slots=True)
class DrivingSession:
    """The session of the ground station in control."""

    id: int
    proven_at: float
    """When its newest good proof arrived."""
    clock: int | None = None
    """`time_boot_ms` of its newest demand; None before the first."""

    def order(self, proof: Proof) -> DemandOrder:
        """Compare a proof with the newest one so far. Clocks wrap after 49 days."""
        if self.clock is None or 0 < (proof.clock - self.clock) % _WRAP < _WRAP // 2:
            return DemandOrder.NEWEST
        return DemandOrder.NOT_NEWER

    def may_be_succeeded(self, now: float) -> bool:
        """Return True if another session with the same system id may take over."""
        return now - self.proven_at > SUCCESSION_TIME


class RecentProofs:
    """The newest good proof of each sender, for the moment in which one takes control."""

    def __init__(self) -> None:
        self._newest: dict[Source, tuple[int, float]] = {}

    def add(self, source: Source, proof: Proof, now: float) -> None:
        """Remember a good proof; of too many senders the one that was added first is forgotten."""
        self._newest.pop(source, None)
        self._newest[source] = (proof.session, now)
        if len(self._newest) > SOURCES_MAX:
            del self._newest[next(iter(self._newest))]

    def session_of(self, source: Source | None, now: float) -> DrivingSession | None:
        """Return the session that this sender has proven within PROOF_VALID, or None."""
        if source is None:
            return None
        session, at = self._newest.get(source, (0, -math.inf))
        return DrivingSession(session, at) if now - at <= PROOF_VALID else None
