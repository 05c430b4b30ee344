"""A command as handlers see it, from COMMAND_LONG or COMMAND_INT."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from dialects.messages import CommandInt, CommandLong
from link.core import Peer, Received
from link.signing.role import SigningRole

PROGRESS_TIMEOUT = 3.0
"""s in which the same command from the same sender is a repeat."""

Params = tuple[float, float, float, float, float, float, float]


def value_or_default(value: float, otherwise: float = 0.0) -> float:
    """Return a parameter's value, or `otherwise` for NaN, which MAVSDK sends in parameters it omits."""
    return otherwise if math.isnan(value) else value


@dataclass(frozen=True, slots=True)
class CommandRequest:
    """One command."""

    command: int
    params: Params
    """Parameters 1..7. From COMMAND_INT, 5 and 6 are `x` and `y` as numbers."""
    frame: int | None
    """MAV_FRAME of a COMMAND_INT; COMMAND_LONG has none."""
    x: int
    y: int
    is_int: bool
    system: int
    component: int
    peer: Peer
    introduced: bool
    may_ask: bool
    numbering: int = field(default=0, compare=False)
    """Its sender's run of packet numbers (link/core.py, Received)."""
    repeated: bool = field(default=False, compare=False)
    """May be a repeat: `confirmation` is above 0, or it is a COMMAND_INT, which has none."""
    role: SigningRole = field(default=SigningRole.SET_UP, compare=False)
    """What the key of its sender allows."""
    signed: bool = field(default=False, compare=False)


def _comparable(param: float) -> float:
    """Return every NaN as the same object, which tuples find equal.

    MAVSDK leaves omitted parameters NaN, and a repeated command must be equal to the first.
    """
    return math.nan if param != param else param


def parse_command(message: CommandLong | CommandInt, received: Received) -> CommandRequest:
    """Return the command of either message."""
    if isinstance(message, CommandInt):
        last: tuple[float, float, float] = (message.x, message.y, message.z)
        frame, x, y = message.frame, message.x, message.y
    else:
        last = (message.param5, message.param6, message.param7)
        frame, x, y = None, 0, 0
    one, two, three, four, five, six, seven = map(
        _comparable, (message.param1, message.param2, message.param3, message.param4, *last)
    )
    return CommandRequest(
        command=message.command,
        params=(one, two, three, four, five, six, seven),
        frame=frame,
        x=x,
        y=y,
        is_int=isinstance(message, CommandInt),
        system=received.system,
        component=received.component,
        peer=received.peer,
        introduced=received.introduced,
        may_ask=received.may_ask,
        numbering=received.numbering,
        repeated=isinstance(message, CommandInt) or message.confirmation > 0,
        role=received.role,
        signed=received.signed,
    )
