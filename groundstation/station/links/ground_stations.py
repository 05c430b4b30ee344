"""The other ground stations that are heard, by system and component id, and which of them uses our system id.

Vehicles cannot tell the demands of two stations with one system id apart. Time is an argument.
"""

from __future__ import annotations

from collections.abc import Callable, Collection

from dialects.enums import VehicleType
from dialects.messages import Heartbeat
from groundstation.views.links import StationRow
from link.core import Received
from link.protocol.heartbeat import HeartbeatMonitor

MAX_STATIONS = 32
"""A flood of invented ids must not grow a table."""

HEARD_WITHIN = 10.0
"""s since its last HEARTBEAT for which a ground station is listed."""


class GroundStations:
    """Notes the HEARTBEATs of ground stations; ours does not arrive here."""

    def __init__(self) -> None:
        self._heard: dict[tuple[int, int], float] = {}

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of any system."""
        message = received.message
        if not isinstance(message, Heartbeat) or message.type != VehicleType.GCS:
            return
        ids = (received.system, received.component)
        if ids not in self._heard and len(self._heard) >= MAX_STATIONS:
            self._expire(now)
        if ids in self._heard or len(self._heard) < MAX_STATIONS:
            self._heard[ids] = now

    def build_rows(self, now: float) -> tuple[StationRow, ...]:
        """Return those that were heard lately."""
        self._expire(now)
        return tuple(StationRow(*ids, round(now - at, 1)) for ids, at in sorted(self._heard.items()))

    def free_id(self, ours: int, vehicles: Collection[int]) -> int:
        """Return the highest system id below 255 that is not ours, and that nobody uses who was heard."""
        used = {ours, *vehicles, *(system for system, _ in self._heard)}
        return next((system for system in range(254, 0, -1) if system not in used), ours)

    def _expire(self, now: float) -> None:
        self._heard = {ids: at for ids, at in self._heard.items() if now - at <= HEARD_WITHIN}


CONFLICT_TIMEOUT = 5.0
"""s after the last HEARTBEAT of the other station for which the conflict is shown."""


class IdConflict:
    """The last ground station heard with our system id and another component id.

    Frames with both of our ids are dropped by the link, which reports them itself. `free_id` returns an id that nobody
    uses.
    """

    def __init__(self, system: int, free_id: Callable[[], int]) -> None:
        self._system, self._free_id = system, free_id
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
        who = f"ground station {self._system}/{self._component}"
        return f"{who} uses our system id: start with --system {self._free_id()}"
