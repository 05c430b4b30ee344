"""Who watches the camera, and what its process says. Time is an argument.

A station watches from its VIDEO_START_STREAMING on, until it stops or is not heard any more. The pictures go to the
address from which it sends.
"""

from __future__ import annotations

from typing import NamedTuple

from link.core import Peer
from link.endpoint import EndpointError, parse_endpoint
from vehicle.camera.settings import CameraSettings

WATCHERS_MAX = 4
"""Stations that get pictures: each costs the bit rate."""
SILENCE = 5.0
"""s without a HEARTBEAT after which a station is gone: it sends one a second."""
NEWS_MAX = 3
"""Texts that wait until a ground station is there; older ones are dropped."""
REPORT_SILENCE = 3.0
"""s without a report after which the process does not run."""

Target = tuple[str, int]
"""Address and port to which pictures are sent."""


class CameraReport(NamedTuple):
    """What the process says once a second."""

    pictures: int = 0
    """Sent in the last second."""
    bits: int = 0
    """Sent in it, to one station."""
    problem: str = ""
    """Why there are none, in one line."""


class Camera:
    """The camera as the core sees it."""

    def __init__(self, settings: CameraSettings) -> None:
        self.settings = settings
        self.report = CameraReport()
        self._reported_at = 0.0
        self._news: list[str] = []
        self._watchers: dict[Peer, tuple[str, float]] = {}
        """Station -> its address, and when it was heard last."""

    def start(self, peer: Peer, now: float) -> str | None:
        """Send pictures to a station. Returns why not, or None."""
        host = find_host(peer)
        if host is None:
            return "pictures need an IP link"
        if peer not in self._watchers and len(self.targets(now)) >= WATCHERS_MAX:
            return f"{WATCHERS_MAX} others watch"
        self._watchers[peer] = host, now
        return None

    def stop(self, peer: Peer) -> None:
        """Send no more pictures to a station."""
        self._watchers.pop(peer, None)

    def hear(self, peer: Peer, now: float) -> None:
        """Note a HEARTBEAT of a station."""
        if peer in self._watchers:
            self._watchers[peer] = self._watchers[peer][0], now

    def targets(self, now: float) -> tuple[Target, ...]:
        """Return where pictures go: none while nobody watches."""
        self._watchers = {peer: (host, at) for peer, (host, at) in self._watchers.items() if now - at <= SILENCE}
        return tuple(dict.fromkeys((host, self.settings.port) for host, _ in self._watchers.values()))

    def note_report(self, report: CameraReport, now: float) -> None:
        """Store what the process says."""
        if report.problem and report.problem != self.report.problem:
            self.tell(f"Camera: {report.problem}")
        self.report, self._reported_at = report, now

    def tell(self, text: str) -> None:
        """Have the ground stations told."""
        self._news = [*self._news, text][-NEWS_MAX:]

    def pop_news(self) -> list[str]:
        """Return what the ground stations are to be told, once."""
        news, self._news = self._news, []
        return news

    def runs(self, now: float) -> bool:
        """Return whether pictures are being sent."""
        return self.report.pictures > 0 and now - self._reported_at <= REPORT_SILENCE


def find_host(peer: Peer) -> str | None:
    """Return the IP address of a peer; None on links that have none, such as a serial port."""
    if isinstance(peer.address, tuple) and peer.address and isinstance(peer.address[0], str):
        return peer.address[0]
    if not isinstance(peer.address, str):
        return None
    try:
        endpoint = parse_endpoint(peer.address)
    except EndpointError:
        return None
    return endpoint.host or None if endpoint.scheme.startswith(("udp", "tcp")) else None
