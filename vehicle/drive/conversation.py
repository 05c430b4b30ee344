"""Who sends: one run of packet numbers of one (system, component) from one peer.

A system id is not an identity: 255 is the default of most ground stations. A program that restarts, one that comes over
another address, a second program with the same ids, and copies of old frames are all other conversations with the
same ids, and one rule decides about them (vehicle/drive/driver.py).
"""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple, Protocol

import msgspec

from link.core import Peer, Received
from link.signing.role import SigningRole

FRAMES_REMEMBERED = 512
"""Frames of the driver's ids that are remembered: each packet number twice."""
FRAMES_BEFORE = 256
"""Frames of each other conversation that are remembered, in case that it takes control."""
NEWCOMERS_MAX = 16
"""Conversations beside the driver's that are remembered."""
FRAMES_OF_A_PROGRAM = 3
"""Frames in order that make a conversation: a single one that fits may be an accident."""

Ids = tuple[int, int]
"""System id and component id."""


class Sender(Protocol):
    """The sender of a message or a command: `link.core.Received` and `CommandRequest` are two."""

    @property
    def system(self) -> int:
        """System id."""

    @property
    def component(self) -> int:
        """Component id."""

    @property
    def peer(self) -> Peer:
        """Where it is."""

    @property
    def numbering(self) -> int:
        """Its run of packet numbers."""

    @property
    def role(self) -> SigningRole:
        """What its key allows."""

    @property
    def signed(self) -> bool:
        """Whether it has signed."""


class Conversation(NamedTuple):
    """One conversation of a ground station with this vehicle."""

    system: int
    component: int
    peer: Peer
    numbering: int

    @classmethod
    def of(cls, sender: Sender) -> Conversation:
        """Return the conversation of the sender of a message or a command."""
        return tuple.__new__(cls, (sender.system, sender.component, sender.peer, sender.numbering))

    @property
    def ids(self) -> Ids:
        """System id and component id."""
        return self.system, self.component

    @property
    def role(self) -> SigningRole:
        """What is asked of a conversation was checked with its message: a key has a role, an address has none."""
        return SigningRole.SET_UP

    @property
    def signed(self) -> bool:
        """As for `role`: not known."""
        return False

    @property
    def may_ask(self) -> bool:
        """Texts may be sent to it: only who has sent a HEARTBEAT takes control."""
        return True


class Newcomer(msgspec.Struct):
    """Another conversation than the driver's."""

    frames: int = 0
    is_copy: bool = True
    """It has only repeated frames of the driver, byte for byte."""
    reported_at: float = -math.inf
    """When the driver was told of it."""
    begun_at: float = math.inf
    """When its first frame came."""
    digests: deque[int] = msgspec.field(default_factory=lambda: deque(maxlen=FRAMES_BEFORE))
    """Its newest frames."""

    @property
    def is_program(self) -> bool:
        """True if it is a program of its own and not some frames that came late, or again."""
        return self.frames >= FRAMES_OF_A_PROGRAM and not self.is_copy


class FrameMemory:
    """What the driver has said last, and who else speaks; kept after the driver has released control."""

    def __init__(self) -> None:
        self._ids: Ids | None = None
        self._digests: dict[int, None] = {}
        self._newcomers: dict[Conversation, Newcomer] = {}

    def begin(self, conversation: Conversation) -> None:
        """Remember the frames of a conversation that takes control, also those that it has sent before."""
        if conversation.ids != self._ids:
            self._ids = conversation.ids
            self._digests.clear()
        newcomer = self._newcomers.pop(conversation, None)
        for digest in newcomer.digests if newcomer else ():
            self._record(digest)

    def is_repeat(self, received: Received) -> bool:
        """Return whether the driver has sent this frame before, byte for byte."""
        return received.digest in self._digests

    def record(self, received: Received) -> None:
        """Remember a frame of the driver."""
        self._record(received.digest)

    def note_newcomer(self, received: Received, now: float) -> Newcomer:
        """Count a frame of another conversation."""
        conversation = Conversation.of(received)
        newcomer = self._newcomers.pop(conversation, None) or Newcomer()
        self._newcomers[conversation] = newcomer
        if len(self._newcomers) > NEWCOMERS_MAX:
            del self._newcomers[next(iter(self._newcomers))]
        newcomer.frames += 1
        newcomer.begun_at = min(newcomer.begun_at, now)
        newcomer.is_copy &= self.is_repeat(received)
        newcomer.digests.append(received.digest)
        return newcomer

    def newcomer(self, conversation: Conversation) -> Newcomer | None:
        """Return what is known of another conversation."""
        return self._newcomers.get(conversation)

    def _record(self, digest: int) -> None:
        if digest:
            self._digests.pop(digest, None)
            self._digests[digest] = None
            if len(self._digests) > FRAMES_REMEMBERED:
                del self._digests[next(iter(self._digests))]
