"""One path to a vehicle: a peer on a link, how late what it brings is, and how much of it is lost."""

from __future__ import annotations

import math

import msgspec

from link.core import Peer

REBOOT_STEP = 5000
"""ms by which the clock of the vehicle must go back on one path to count as a reboot."""
LIVE = 2.5
"""s without a message for which a path is there: two and a half heartbeats."""
LATE = 0.45
"""s behind the fastest path from which on a path brings old news: our vehicle takes no demand of this age."""
WRAP = 2**32
"""Of time_boot_ms, after 49 days."""
UNKNOWN_TRIP = 0.1
"""s taken for a round trip that is not measured yet."""


class Path(msgspec.Struct):
    """What is known of one path. Times in s."""

    peer: Peer
    heard_at: float = -math.inf
    stamp: int | None = None
    """Newest time_boot_ms that it has brought, ms; None: it has brought none."""
    offset: float = math.inf
    """From the clock of the vehicle to ours, as its newest stamp shows."""
    lag: float = 0.0
    """How much later than by the fastest path its newest stamp has arrived."""
    old_boot: bool = False
    """Another path has shown a reboot, and this one has not: what it brings is from before."""
    heard: int = 0
    """Messages since the path that counts was heard last."""
    loss: float = 0.0
    """Lost fraction of the vehicle's frames, 0..1."""
    round_trip: float | None = None

    def is_live(self, now: float) -> bool:
        """Return whether it is heard."""
        return now - self.heard_at <= LIVE

    def note_stamp(self, stamp: int, now: float) -> bool:
        """Note a time_boot_ms; return whether it shows a reboot."""
        back = 0 if self.stamp is None else is_older(stamp, self.stamp)
        rebooted = back > REBOOT_STEP
        if rebooted:
            self.old_boot = False
        if rebooted or not back:
            self.stamp, self.offset = stamp, now - stamp / 1000
        return rebooted

    @property
    def cost(self) -> float:
        """How long a message with its answer takes on average, s, repeats included. The least is the best."""
        trip = UNKNOWN_TRIP if self.round_trip is None else self.round_trip
        return (0.02 + self.lag + trip) / max(0.05, 1.0 - self.loss) ** 2

    def age(self, now: float) -> float:
        """Return how old its newest news is: how late it came, and how long ago."""
        return self.lag + max(0.0, now - self.heard_at)


def is_older(stamp: int, than: int) -> int:
    """Return by how many ms a time_boot_ms is older than another one; 0 if it is not."""
    back = (than - stamp) % WRAP
    return back if back < WRAP // 2 else 0
