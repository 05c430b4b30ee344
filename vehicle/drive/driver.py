"""The driver: one conversation, or one operator session that proves itself with each demand.

Everybody may stop the vehicle. All else is the driver's: demands, modes, release, parameters, plans. Another program
with its ids succeeds it only when the driver is silent.
"""

from __future__ import annotations

import math

import msgspec

from vehicle.drive.conversation import Conversation, Sender
from vehicle.drive.operator_session import DrivingSession

SUCCESSION_TIME = 0.7
"""s of silence of a driver that streams demands after which another program with its ids takes over. Longer than
OPR_ECHO_MAX and one interval at 5 Hz, so that two idle programs do not take turns at 10 % loss; below 1 s, so that a
restarted ground station drives again within 1 s."""
CLASH_PAUSE = 0.7
"""s after the last clash of two programs in one numbering for which no demand counts."""


class Driver(msgspec.Struct):
    """The ground station in control."""

    conversation: Conversation
    """Of a session: the one that has brought its newest good proof."""
    session: DrivingSession | None
    """None for a ground station whose demands carry no proof of their age."""
    last_heard: float
    """When its newest message arrived; of a session its newest good proof, because any program may send the rest."""
    is_copy: bool = False
    """Since it began, or after a silence, it has only repeated frames: its demands do not count until it says
    something else, because copies of old frames look like this."""
    demand_at: float = -math.inf
    """When its newest demand arrived."""
    barred_until: float = -math.inf
    """No demand counts before: another program counts in the same numbering."""
    clash_reported_at: float = -math.inf
    """When that was reported last."""

    @property
    def name(self) -> str:
        """Its ids as "255/190"."""
        return f"{self.conversation.system}/{self.conversation.component}"

    def is_sender(self, sender: Sender, now: float) -> bool:
        """Return whether a message or command is from the driver."""
        if self.session is not None:
            return self.session.is_proven(Conversation.of(sender), now)
        system, component, peer, numbering = self.conversation
        return (
            sender.numbering == numbering
            and sender.system == system
            and sender.component == component
            and sender.peer == peer
        )

    def is_barred(self, now: float) -> bool:
        """Return whether only stops count, because it cannot be told from another program."""
        return now < self.barred_until

    def may_be_succeeded(self, now: float, *, by_session: bool, timeout: float) -> bool:
        """Return whether another program with the driver's ids may take over. `timeout`: FS_GCS_TIMEOUT in s.

        A session is followed by a session, and a driver that streamed demands to its end by anybody, after
        SUCCESSION_TIME. One that sent heartbeats only is not missed so soon.
        """
        streamed = self.last_heard - self.demand_at <= SUCCESSION_TIME
        soon = by_session if self.session is not None else streamed
        return now - self.last_heard > (SUCCESSION_TIME if soon else timeout)

    def hear(self, now: float, *, is_demand: bool, repeated: bool) -> None:
        """Note a message of a driver without sessions. `repeated`: it has sent the same frame before."""
        if now - self.last_heard > SUCCESSION_TIME:
            self.is_copy = True
        self.is_copy &= repeated
        self.last_heard = now
        if is_demand:
            self.demand_at = now
