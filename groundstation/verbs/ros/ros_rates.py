"""How often a vehicle sends what a node of ROS publishes."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Command
from groundstation.verbs.common.arguments import Argument, rate
from groundstation.verbs.session.session import VerbSession

RATE: Argument = ("--rate", {"type": rate, "default": 5.0, "metavar": "HZ", "help": "of odom and imu (default: 5)"})
REQUESTED: dict[type[m.Message], float] = {
    m.Attitude: 1.0,
    m.LocalPositionNed: 1.0,
    m.HighresImu: 1.0,
    m.GpsRawInt: 0.2,
    m.BatteryStatus: 0.1,
}
"""Message -> its share of --rate."""


async def request_rates(session: VerbSession, hertz: float) -> None:
    """Request the messages that are published; a vehicle that refuses sends what it sends anyway."""
    commands = session.services.commands
    for kind, share in REQUESTED.items():
        params = (float(kind.id), round(1e6 / (hertz * share)))
        await session.request(
            lambda number, now, p=params, k=kind: commands.send(  # type: ignore[misc]
                number, Command.SET_MESSAGE_INTERVAL, p, f"rate of {k.msgname}", now
            )
        )
