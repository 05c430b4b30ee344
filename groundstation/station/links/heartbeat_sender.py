"""The station's own HEARTBEAT: once a second, faster while driving and after a vehicle appears at a new address."""

from __future__ import annotations

from dialects.enums import Autopilot, SystemState, VehicleType
from dialects.messages import Heartbeat
from groundstation.vehicles.state.vehicle_heartbeat import MAX_VEHICLES
from link.core import Outgoing, Peer

HEARTBEAT_PERIOD = 1.0
"""s (https://mavlink.io/en/services/heartbeat.html)."""

DRIVING_PERIOD = 0.25
"""s between heartbeats while we drive: from another address (another network, a new NAT port) a vehicle obeys us only
after a heartbeat, and drives again within 1 s of the change."""

GREETING, GREETING_PERIOD = 1.0, 0.2
"""s for which, and s between which, heartbeats go to a vehicle at a new address: all are lost once in 400 at 30 %."""

EARLY, LATEST = 0.02, 0.15
"""s by which a heartbeat may be early, because ticks come a little late, and late without being put off."""

MAX_PEERS = 2 * MAX_VEHICLES
"""Addresses of vehicles remembered; each restart of a vehicle may bring another. With fewer places than vehicles all of
them would be greeted for ever."""


class HeartbeatSender:
    """Decides when the next HEARTBEAT is due. `tick` is called only while the operator's screen is alive."""

    def __init__(self, now: float) -> None:
        self._due = self._sent_at = 0.0
        self._known: set[Peer] = set()
        self._greet_until = now

    def greet(self, peer: Peer, now: float) -> None:
        """Start the fast rate for a new peer: it accepts commands only from those whose heartbeat it has received."""
        if peer in self._known:
            return
        if len(self._known) >= MAX_PEERS:
            self._known.clear()
        self._known.add(peer)
        self._due, self._greet_until = now, now + GREETING

    def is_greeting(self, now: float) -> bool:
        """Return whether a vehicle has appeared at a new address in the last GREETING."""
        return now < self._greet_until

    def tick(self, now: float, *, driving: bool) -> list[Outgoing]:
        """Return the heartbeat to send now, if one is due. `driving`: we control an armed vehicle."""
        if driving:
            self._due = min(self._due, self._sent_at + DRIVING_PERIOD)
        if now < self._due - EARLY:
            return []
        self._sent_at = self._due if now - self._due < LATEST else now  # a late tick must not lower the rate
        self._due = self._sent_at + (GREETING_PERIOD if self.is_greeting(now) else HEARTBEAT_PERIOD)
        return [Outgoing(Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, SystemState.ACTIVE, 3))]
