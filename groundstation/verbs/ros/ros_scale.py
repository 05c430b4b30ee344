"""What full deflection is for a Twist: options of the user, else parameters of the vehicle."""

from __future__ import annotations

import argparse
import math

from groundstation.ros.demand import DEFAULT_SPEED, DEFAULT_TURN, Scale
from groundstation.verbs.common.arguments import Argument, finite, metres_per_second
from groundstation.verbs.session.session import VerbSession

SPEED_PARAMETER, TURN_PARAMETER = "SPEED_MAX", "ACRO_TURN_RATE"
"""m/s at full throttle, and deg/s at full steering: of our vehicle and of ArduPilot Rover."""
FASTEST_TURN = 4 * math.pi
"""rad/s, two turns a second."""


def radians_per_second(text: str) -> float:
    """Parse a turn rate. Raises ArgumentTypeError."""
    value = finite(text)
    if not 0 < value <= FASTEST_TURN:
        raise argparse.ArgumentTypeError(f"{text!r} is not a turn rate above 0 and up to {FASTEST_TURN:.1f} rad/s")
    return value


ARGUMENTS: tuple[Argument, ...] = (
    ("--max-speed", {"type": metres_per_second, "metavar": "M/S",
                     "help": "linear.x that is full throttle (default: SPEED_MAX of the vehicle, else 1)"}),
    ("--max-turn", {"type": radians_per_second, "metavar": "RAD/S",
                    "help": "angular.z that is full steering (default: ACRO_TURN_RATE of the vehicle, else 1)"}),
    ("--arm", {"action": "store_true", "help": "arm at the start, and disarm at the end"}),
)  # fmt: skip
"""Arguments of every program that drives by messages of ROS."""


async def learn_scale(session: VerbSession, options: argparse.Namespace) -> Scale:
    """Return the scale; ask the vehicle for what the user has not said."""
    speed = options.max_speed or await _read(session, SPEED_PARAMETER) or DEFAULT_SPEED
    turn = options.max_turn or math.radians(await _read(session, TURN_PARAMETER) or 0.0) or DEFAULT_TURN
    return Scale(speed=speed, turn=turn)


async def _read(session: VerbSession, name: str) -> float | None:
    """Return a parameter that is a positive number, or None."""
    params = session.services.params
    await session.request(lambda number, now: params.read(number, name, now))
    known = params.client.params.get(name)
    return known.value if known is not None and math.isfinite(known.value) and known.value > 0 else None
