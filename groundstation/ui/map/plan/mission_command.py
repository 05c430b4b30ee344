"""What a command of a plan needs: labels, units and ranges of its parameters."""

from __future__ import annotations

import msgspec


class CommandParam(msgspec.Struct, frozen=True):
    """One parameter, 1 to 7."""

    number: int
    label: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    step: float | None = None
    """1.0: whole numbers."""


class MissionCommand(msgspec.Struct, frozen=True):
    """One MAV_CMD."""

    name: str
    """Without MAV_CMD_."""
    has_location: bool
    """Parameters 5 to 7 are a position."""
    params: tuple[CommandParam, ...] = ()
    """Those in use, without a position."""
