"""Traffic classes of a fleet: which frames overtake others, and which are sent again when they are lost. Sans-IO.

Frames keep their order within a class. The classes hold the lanes of MAVLink signing (link/protocol/signing_guard.py)
together, so that overtaking never looks like a replay. No class waits for room: a put that blocks would stop the loop
that drives the motors.
"""

from __future__ import annotations

from enum import Enum

import msgspec

from dialects.traits import ACKED, NEWEST_ONLY, URGENT


class TrafficPriority(Enum):
    """Zenoh's names of the priorities that are used here, as in its configuration."""

    REAL_TIME = "real_time"
    INTERACTIVE_HIGH = "interactive_high"
    DATA = "data"


class TrafficClass(msgspec.Struct, frozen=True):
    """One quality of service."""

    word: str
    """As part of a key."""
    priority: TrafficPriority
    reliable: bool
    """Sent again when it is lost, on links that can lose; an old demand is a wrong one, so those are not."""
    express: bool
    """Sent at once, never collected with others."""


CONTROL = TrafficClass("ctl", TrafficPriority.REAL_TIME, reliable=False, express=True)
"""Demands and heartbeats: the newest counts."""
COMMAND = TrafficClass("cmd", TrafficPriority.INTERACTIVE_HIGH, reliable=True, express=True)
"""Commands, modes and acknowledgements."""
TRANSFER = TrafficClass("rel", TrafficPriority.DATA, reliable=True, express=False)
"""Parameters, plans, files, texts."""
TELEMETRY = TrafficClass("tlm", TrafficPriority.DATA, reliable=False, express=False)
"""Everything else."""
CLASSES = (CONTROL, COMMAND, TRANSFER, TELEMETRY)


def traffic_class(message_id: int) -> TrafficClass:
    """Return the class of a message."""
    if message_id in NEWEST_ONLY:
        return CONTROL
    if message_id in URGENT:
        return COMMAND
    return TRANSFER if message_id in ACKED else TELEMETRY
