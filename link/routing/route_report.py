"""What a router tells of its work: counts of each wire, and the table of routes."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from link.routing.routes import RoutedPeer


@dataclass(frozen=True, slots=True)
class RouteReport:
    """One line of the table of routes."""

    system: int
    component: int
    port: int
    address: Hashable
    silence: float
    """s since it was last heard there."""
    received: int
    lost: int


@dataclass(slots=True)
class TransportReport:
    """What one wire has carried since the start."""

    peers: int = 0
    frames_in: int = 0
    bytes_in: int = 0
    frames_out: int = 0
    bytes_out: int = 0
    received: int = 0
    """Frames whose numbers were followed; with `lost` they give the loss."""
    lost: int = 0
    crc_errors: int = 0
    noise_bytes: int = 0
    unknown: int = 0
    """Frames of ids that we do not know, forwarded all the same."""

    def copy(self) -> TransportReport:
        """Another one with the same counts."""
        return replace(self)

    def add(self, peer: RoutedPeer) -> None:
        """Count what one peer has carried."""
        self.bytes_in += peer.bytes_in
        self.frames_out += peer.frames_out
        self.bytes_out += peer.bytes_out
        self.received += sum(each.received for each in peer.sources.values())
        self.lost += sum(each.lost for each in peer.sources.values())
        counts = peer.framer.counts
        self.frames_in += counts.frames + counts.unknown
        self.crc_errors += counts.crc_errors
        self.noise_bytes += counts.resync_bytes
        self.unknown += counts.unknown
