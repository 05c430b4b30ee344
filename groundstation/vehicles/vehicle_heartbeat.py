"""Tells the HEARTBEAT of a vehicle from others."""

from __future__ import annotations

from dialects.enums import Autopilot, VehicleType
from dialects.messages import Heartbeat, Message

MAX_VEHICLES = 128
"""A hundred and some. A flood of invented system ids must not grow a table."""


def is_vehicle(message: Message) -> bool:
    """Return whether this is the HEARTBEAT of a vehicle, not of a ground station, a camera or a radio."""
    return isinstance(message, Heartbeat) and message.type != VehicleType.GCS and message.autopilot != Autopilot.INVALID
