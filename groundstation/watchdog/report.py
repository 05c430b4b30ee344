"""What the station process tells the watchdog ten times a second. The newest report counts.

Each is complete but for the descriptors, which travel again only when they have changed.
"""

from __future__ import annotations

import msgspec

from groundstation.station.driving.driven import WatchdogTarget
from link.protocol.signing_guard import SigningContext

MAX_OUTLETS = 32
"""Descriptors in one report; more than any station has links. The kernel allows 253."""

MAX_REPORT = 1 << 16
"""Bytes of the largest report."""


class DemandRoute(msgspec.Struct, frozen=True):
    """Where the demands to a vehicle leave. The descriptors of all routes are in this order."""

    vehicle: int
    """Index in `vehicles` of the report."""
    destination: tuple[str | int, ...] | None
    """The address for sendto(); None for a connected descriptor."""
    sequence: int
    """Packet sequence of the newest frame that was sent there."""
    signing: SigningContext | None = None
    """How frames are signed there; None: they are not."""
    version_1: bool = False
    """The vehicle takes MAVLink 1 only."""


class StationReport(msgspec.Struct, frozen=True, kw_only=True):
    """The station runs; this is what the watchdog needs if it does not any more."""

    ids: tuple[int, int] = (255, 190)
    """System and component id of the station."""
    vehicles: tuple[WatchdogTarget, ...] = ()
    routes: tuple[DemandRoute, ...] = ()
    keeps_descriptors: bool = False
    """The descriptors are those of the report before. Else they travel with this one."""
    screen_has_quit: bool = False
    """The screen ends in order, and leaves the terminal as it was."""
    screen_is_gone: bool = False
    """The screen's process has ended without that."""
    rests: bool = False
    """The station rests: the next report may follow REST_STALL_TIMEOUT later (station/driving/stall.py)."""
    keys_version: int = 0
    """How often the keys have changed: with another number the watchdog reads them again."""
    ending: bool = False
    """The station has sent its last neutral demands and ends."""


encode_report = msgspec.msgpack.Encoder().encode
decode_report = msgspec.msgpack.Decoder(StationReport).decode
