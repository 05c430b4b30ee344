"""LinkMonitor: what this station knows of its links, and of the programs at their other ends."""

from __future__ import annotations

from collections.abc import Sequence

from dialects.enums import Severity
from groundstation.station.links.ground_stations import GroundStations
from groundstation.station.links.heard_params import HeardParams
from groundstation.station.links.heartbeat_sender import HeartbeatSender
from groundstation.station.links.id_conflict import IdConflict
from groundstation.station.links.link_stats import LinkStats
from groundstation.station.links.surroundings import Surroundings
from groundstation.vehicles.state.message_log import MessageLog
from link.core import LinkReport, Received
from link.protocol.link_events import LinkEvents
from link.services.timesync import TimesyncClient


class LinkMonitor:
    """The state of all links, the heartbeat and the clocks on them, and other programs. `system` is our system id."""

    def __init__(self, endpoints: Sequence[str], log: MessageLog, system: int, now: float) -> None:
        self._log = log
        self.surroundings = Surroundings(endpoints)
        self.stats = LinkStats()
        self.timesync = TimesyncClient(system)
        self.heartbeat = HeartbeatSender(now)
        self.stations = GroundStations()
        self.params = HeardParams()
        self.id_conflict = IdConflict(system)
        self._events = LinkEvents()

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of any system: other ground stations and components send, too."""
        conflict = self.id_conflict.receive(received, now)
        if conflict is not None:
            self._log.add(now, "station", conflict, Severity.WARNING)
        self.stations.receive(received, now)
        self.params.receive(received)

    def log_events(self, reports: Sequence[LinkReport], now: float) -> None:
        """Log when a problem of a link starts and ends."""
        for report in reports:
            event = self._events.update(report)
            if event:
                self._log.add(now, "station", f"{report.name}: {event.text}", event.severity)
