"""What the station and the process that receives pictures tell each other, as JSON in packets."""

from __future__ import annotations

import msgspec


class StreamOrders(msgspec.Struct, frozen=True):
    """From the station, the newest counts."""

    port: int = 0
    """UDP port of this machine at which the stream comes; 0: receive nothing."""
    screens: tuple[int, ...] = ()
    """Ports of loopback at which decoders of screens listen."""
    stamped: bool = False
    """The pictures have their time in their top rows."""
    log: str = ""
    """Path of the telemetry log beside which pictures are recorded; "": do not record."""
    offset: int = 0
    """us to add to the monotonic clock for the times in that log."""
    senders: tuple[str, ...] = ()
    """IP addresses that may send it; (): the first one that does."""


class StreamReport(msgspec.Struct, frozen=True):
    """From the process, once a second and when something has changed."""

    problem: str = ""
    """Why nothing is received, in one line."""
    recorded: str = ""
    """The file that is being written."""
    failure: str = ""
    """Why pictures are not recorded, in one line."""
