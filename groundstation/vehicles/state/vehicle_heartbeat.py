"""Tells the HEARTBEAT of a vehicle from others, and which component of a system is the vehicle."""

from __future__ import annotations

from dialects.enums import Autopilot
from dialects.kinds import AUTOPILOT_COMPONENT, NO_VEHICLES
from dialects.messages import Heartbeat, Message

MAX_VEHICLES = 128
"""A hundred and some. A flood of invented system ids must not grow a table."""


def is_vehicle(message: Message) -> bool:
    """Return whether this is the HEARTBEAT of a vehicle, not of a ground station, a part of a vehicle or a radio."""
    return isinstance(message, Heartbeat) and message.type not in NO_VEHICLES and message.autopilot != Autopilot.INVALID


def replaces(component: int, other: int) -> bool:
    """Return whether a component that sends HEARTBEATs of a vehicle is the vehicle in place of `other`.

    The order in which they are heard is chance: the autopilot sends once a second, a script on board may be faster.
    """
    return component == AUTOPILOT_COMPONENT != other
