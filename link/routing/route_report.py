"""What a router reports: the traffic of each link, and the table of routes."""

from __future__ import annotations

from collections.abc import Hashable

import msgspec
from msgspec.structs import replace


class RouteReport(msgspec.Struct, frozen=True):
    """One row of the table of routes."""

    system: int
    component: int
    link: int
    """Index of the link."""
    address: Hashable
    silence: float
    """s since the last frame from there."""
    received: int
    lost: int


class TransportReport(msgspec.Struct):
    """What one transport, or one peer on it, has carried since the start."""

    peers: int = 0
    frames_in: int = 0
    bytes_in: int = 0
    frames_out: int = 0
    bytes_out: int = 0
    received: int = 0
    """Frames with a tracked sequence; with `lost` they give the loss."""
    lost: int = 0
    crc_errors: int = 0
    noise_bytes: int = 0
    unknown: int = 0
    """Frames with an id outside the dialect, which are forwarded as well."""

    def copy(self) -> TransportReport:
        """Return a report with the same counts."""
        return replace(self)

    def add(self, more: TransportReport) -> None:
        """Add the counts of another report."""
        for name in self.__struct_fields__:
            setattr(self, name, getattr(self, name) + getattr(more, name))
