"""Tells the HEARTBEAT of a vehicle from others."""

from __future__ import annotations

from dialects.enums import Autopilot, VehicleType
from dialects.messages import Heartbeat, Message
from link.protocol.peer_table import MAX_PEERS

MAX_VEHICLES = 128
"""A hundred and some. A flood of invented system ids must not grow a table."""

PLACES = MAX_VEHICLES + MAX_PEERS
"""Peers on one link: each vehicle may have an address of its own, and ground stations come beside them."""


def is_vehicle(message: Message) -> bool:
    """Return whether this is the HEARTBEAT of a vehicle, not of a ground station, a camera or a radio."""
    return isinstance(message, Heartbeat) and message.type != VehicleType.GCS and message.autopilot != Autopilot.INVALID
