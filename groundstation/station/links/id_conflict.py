"""Notices another ground station that uses our system id: vehicles cannot tell the demands of the two apart."""

from __future__ import annotations

from dialects.enums import VehicleType
from dialects.messages import Heartbeat
from link.core import Received
from link.protocol.heartbeat import HeartbeatMonitor

CONFLICT_TIMEOUT = 5.0
"""s after the last HEARTBEAT of the other station for which the conflict is shown."""


class IdConflict:
    """The last ground station heard with our system id and another component id.

    Frames with both of our ids are dropped by the link, which reports them itself.
    """

    def __init__(self, system: int) -> None:
        self._system = system
        self._component = 0
        self._monitor = HeartbeatMonitor(CONFLICT_TIMEOUT)

    def receive(self, received: Received, now: float) -> str | None:
        """Handle a message. Returns the text to log when a conflict begins."""
        message = received.message
        if received.system != self._system or not isinstance(message, Heartbeat) or message.type != VehicleType.GCS:
            return None
        begins = not self._monitor.is_alive(now) or received.component != self._component
        self._component = received.component
        self._monitor.update(now)
        return self.text(now) if begins else None

    def text(self, now: float) -> str | None:
        """Return which station uses our system id at present; None when there is none."""
        if not self._monitor.is_alive(now):
            return None
        return f"ground station {self._system}/{self._component} uses our system id: use --system"
