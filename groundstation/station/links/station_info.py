"""What the shell around the core knows: the endpoints, the simulator and this machine, for the next snapshot."""

from __future__ import annotations

from collections.abc import Sequence

from groundstation.snapshot import RecordingView
from link.core import LinkReport

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
