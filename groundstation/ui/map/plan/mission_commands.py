"""Labels, units and ranges of the parameters of each MAV_CMD that a plan may hold.

The table is mission_commands.json beside this file, written by dialects/command_params.py from common.xml: the screen's
process does not load the dialect.
"""

from __future__ import annotations

from pathlib import Path

import msgspec


class CommandParam(msgspec.Struct, frozen=True, array_like=True):
    """One parameter, 1 to 7."""

    number: int
    label: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    step: float | None = None
    """1.0: whole numbers."""


class MissionCommand(msgspec.Struct, frozen=True, array_like=True):
    """One MAV_CMD."""

    name: str
    """Without MAV_CMD_."""
    has_location: bool
    """Parameters 5 to 7 are a position."""
    params: tuple[CommandParam, ...] = ()
    """Those in use, without a position."""


TABLE = Path(__file__).with_name("mission_commands.json")

MISSION_COMMANDS = msgspec.json.decode(TABLE.read_bytes(), type=dict[int, MissionCommand])
"""The commands by the number of their MAV_CMD."""
