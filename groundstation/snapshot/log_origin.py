"""LogOrigin: which vehicle a line of the message log came from, and the MAV_RESULT that it reports."""

from __future__ import annotations

import msgspec


class LogOrigin(msgspec.Struct, frozen=True):
    """Source of a line that a vehicle caused."""

    system: int
    component: int = 0
    """0: any of its components."""
    vehicle: str = ""
    """Its name when the line was added."""
    result: int | None = None
    """MAV_RESULT of the COMMAND_ACK, also one without a name; None for any other line."""
