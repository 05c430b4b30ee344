"""Turns COMMAND_LONG into COMMAND_INT and back: parameters 5 and 6 are degrees in the one, integers in the other."""

from __future__ import annotations

import math

from dialects import rover
from dialects.messages import CommandInt, CommandLong

LOCATED = frozenset(
    {
        16, 17, 18, 19, 21, 22, 23, 24, 25, 31, 34, 35, 36, 80, 81, 82, 84, 85, 94, 179, 188, 189, 192, 195, 201, 252,
        4001, 4501, 5000, 5001, 5002, 5003, 5004, 5100, 30001, 31000, 31001, 31002, 31003, 31004, 31005, 31006, 31007,
        31008, 31009, 43003, 611,
    }
)  # fmt: skip
"""MAV_CMDs whose parameters 5 and 6 are latitude and longitude (hasLocation in common.xml; 611 is newer)."""

PLACELESS = frozenset(rover.enums["MAV_CMD"]) - LOCATED
"""MAV_CMDs of common.xml whose parameters 5 and 6 are not a place, whatever the frame of coordinates says."""

DEGREE, METRE = 1e7, 1e4
"""Units of `x` and `y` of a COMMAND_INT in a degree, and in a metre of a local frame."""

UNUSED = 0x7FFFFFFF
"""`x` or `y` that is not used: NaN of a COMMAND_LONG (https://mavlink.io/en/services/command.html)."""

_LOCAL = frozenset(
    {
        rover.MAV_FRAME_LOCAL_NED, rover.MAV_FRAME_LOCAL_ENU, rover.MAV_FRAME_LOCAL_OFFSET_NED,
        rover.MAV_FRAME_BODY_NED, rover.MAV_FRAME_BODY_OFFSET_NED, rover.MAV_FRAME_BODY_FRD,
        rover.MAV_FRAME_LOCAL_FRD, rover.MAV_FRAME_LOCAL_FLU,
    }
)  # fmt: skip


def to_command_int(message: CommandLong) -> CommandInt | None:
    """Return the same command as COMMAND_INT; None if parameter 5 or 6 does not fit an integer."""
    unit = DEGREE if message.command in LOCATED else 1.0
    x, y = (_to_integer(value * unit) for value in (message.param5, message.param6))
    if x is None or y is None:
        return None
    return CommandInt(
        message.target_system, message.target_component, rover.MAV_FRAME_GLOBAL, message.command, 0, 0,
        message.param1, message.param2, message.param3, message.param4, x, y, message.param7,
    )  # fmt: skip


def to_command_long(message: CommandInt, confirmation: int = 0) -> CommandLong:
    """Return the same command as COMMAND_LONG. A position loses digits: float32 holds a degree to about 1 m."""
    unit = 1.0 if message.command not in LOCATED else METRE if message.frame in _LOCAL else DEGREE
    x, y = (math.nan if value == UNUSED else value / unit for value in (message.x, message.y))
    return CommandLong(
        message.target_system, message.target_component, message.command, confirmation,
        message.param1, message.param2, message.param3, message.param4, x, y, message.z,
    )  # fmt: skip


def _to_integer(value: float) -> int | None:
    if math.isnan(value):
        return UNUSED
    return round(value) if abs(value) < UNUSED else None
