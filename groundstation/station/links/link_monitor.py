"""LinkMonitor: what this station knows of its links, and of the programs at their other ends."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from dialects import messages as m
from dialects.enums import Severity
from groundstation.snapshot import RecordingView
from groundstation.station.links.ground_stations import GroundStations, IdConflict
from groundstation.station.links.heartbeat_sender import HeartbeatSender
from groundstation.station.links.link_stats import LinkStats
from groundstation.station.links.path_figures import FiguresByLink, find_figures
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.state.message_log import MessageLog
from link.core import LinkReport, Received
from link.protocol.link_events import LinkEvents
from link.services.param.values import name_from_wire
from link.services.timesync import TimesyncClient

NO_LINK = "no link yet: Connect opens one"


class StationInfo:
    """The newest of each; set by the station process."""

    def __init__(self, endpoints: Sequence[str]) -> None:
        self.endpoints = tuple(endpoints)
        """Of all links, as the user wrote them."""
        self.not_open: tuple[LinkReport, ...] = ()
        """Reports of the links that are not open."""
        self.simulator: str | None = None
        """State of the simulator; None without one."""
        self.simulated: frozenset[int] = frozenset()
        """System ids of the simulators that end with this station."""
        self.recording: RecordingView | None = None
        """The recording; None without one."""
        self.addresses: tuple[str, ...] = ()
        """IPv4 addresses of this machine."""

    def set_links(self, endpoints: Sequence[str], not_open: Sequence[LinkReport]) -> None:
        """Record the endpoints of all links, and the reports of those that are not open."""
        self.endpoints, self.not_open = tuple(endpoints), tuple(not_open)

    def waiting(self, *, has_traffic: bool) -> str:
        """Return what the station waits for while there is no vehicle."""
        if has_traffic:
            return "receiving data, but no HEARTBEAT of a vehicle yet"
        return f"waiting for a vehicle on {', '.join(self.endpoints)}" if self.endpoints else NO_LINK


MAX_NAMES = 20_000
"""Of all vehicles; ArduPilot has 1200, PX4 1000."""


class HeardParams:
    """Collects the names in PARAM_VALUE."""

    def __init__(self) -> None:
        self.names: set[str] = set()

    def receive(self, received: Received) -> None:
        """Handle a message; only PARAM_VALUE counts."""
        if isinstance(received.message, m.ParamValue) and len(self.names) < MAX_NAMES:
            self.names.add(name_from_wire(received.message._param_id_raw))


class LinkMonitor:
    """The state of all links, the heartbeat and the clocks on them, and other programs. `system` is our system id."""

    def __init__(self, endpoints: Sequence[str], log: MessageLog, system: int, now: float) -> None:
        self._log = log
        self.station_info = StationInfo(endpoints)
        self.stats = LinkStats()
        self.timesync = TimesyncClient(system)
        self.heartbeat = HeartbeatSender(now)
        self.stations = GroundStations()
        self.params = HeardParams()
        self.id_conflict = IdConflict(system, lambda: self.stations.free_id(system, ()))
        self._events = LinkEvents()

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of any system: other ground stations and components send, too."""
        conflict = self.id_conflict.receive(received, now)
        if conflict is not None:
            self._log.add(now, "station", conflict, Severity.WARNING)
        self.stations.receive(received, now)
        self.params.receive(received)

    def measure_paths(self, fleet: Fleet, now: float) -> None:
        """Tell the paths of each vehicle what was measured of their links."""
        for contact in fleet:
            system = contact.state.system
            contact.state.paths.observe(partial(self._loss, system), partial(self.timesync.round_trip_of, now=now), now)

    def find_figures(self, contact: Contact | None, now: float) -> FiguresByLink:
        """Return what is measured of each path to a vehicle, by link."""
        return find_figures(contact, partial(self.timesync.round_trip_of, now=now), now)

    def _loss(self, system: int, link: int) -> float | None:
        return self.stats.loss(link, system)

    def log_events(self, reports: Sequence[LinkReport], now: float) -> None:
        """Log when a problem of a link starts and ends."""
        for report in reports:
            event = self._events.update(report)
            if event:
                self._log.add(now, "station", f"{report.name}: {event.text}", event.severity)
