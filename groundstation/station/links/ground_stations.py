"""The other ground stations that are heard, by system and component id. Bounded; time is an argument."""

from __future__ import annotations

from dialects.enums import VehicleType
from dialects.messages import Heartbeat
from groundstation.views.links import StationRow
from link.core import Received

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

    def _expire(self, now: float) -> None:
        self._heard = {ids: at for ids, at in self._heard.items() if now - at <= HEARD_WITHIN}
