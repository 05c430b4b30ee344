"""What full deflection is for a Twist: options of the user, else parameters of the vehicle."""

from __future__ import annotations

import argparse
import math

from dialects.kinds import AxisLimits, SpeedParam
from groundstation.ros.demand import DEFAULT_CLIMB, DEFAULT_SPEED, DEFAULT_TURN, Scale
from groundstation.verbs.common.arguments import Argument, finite, metres_per_second
from groundstation.verbs.session.session import VerbSession

GROUND_LIMITS = AxisLimits(speed=(SpeedParam("SPEED_MAX"),), turn=(SpeedParam("ACRO_TURN_RATE"),))
"""Of our vehicle and of ArduPilot Rover."""
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
                     "help": "linear.x that is full throttle (default: as the vehicle's parameters say, else 1)"}),
    ("--max-turn", {"type": radians_per_second, "metavar": "RAD/S",
                    "help": "angular.z that is full steering (default: as the vehicle's parameters say, else 1)"}),
    ("--arm", {"action": "store_true", "help": "arm at the start, and disarm at the end"}),
)  # fmt: skip
"""Arguments of every program that drives by messages of ROS."""


async def learn_scale(session: VerbSession, options: argparse.Namespace) -> Scale:
    """Return the scale; ask the vehicle for what the user has not said."""
    model = session.vehicle.model
    limits = model.limits if model.flies else GROUND_LIMITS
    speed = options.max_speed or await _read(session, limits.speed) or DEFAULT_SPEED
    turn = options.max_turn or math.radians(await _read(session, limits.turn) or 0.0) or DEFAULT_TURN
    climb = (await _read(session, limits.climb) or DEFAULT_CLIMB) if model.flies else DEFAULT_CLIMB
    return Scale(speed=speed, turn=turn, climb=climb, flies=model.flies)


async def _read(session: VerbSession, choices: tuple[SpeedParam, ...]) -> float | None:
    """Return the first parameter that the vehicle has, if it is a positive number, or None."""
    for each in choices:
        if (value := await _read_one(session, each.name)) is not None:
            return value * each.scale
    return None


async def _read_one(session: VerbSession, name: str) -> float | None:
    params = session.services.params
    await session.request(lambda number, now: params.read(number, name, now))
    known = params.client.params.get(name)
    return known.value if known is not None and math.isfinite(known.value) and known.value > 0 else None
