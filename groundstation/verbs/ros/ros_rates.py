"""What a node of ROS publishes of a vehicle, and how often the vehicle sends it."""

from __future__ import annotations

import time
from collections.abc import Callable

from dialects import messages as m
from groundstation.ros.vehicle import RosVehicle, Values
from groundstation.verbs.common.arguments import Argument, rate
from groundstation.verbs.session.rates import request_interval
from groundstation.verbs.session.session import VerbSession
from link.core import Received

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
    for kind, share in REQUESTED.items():
        await request_interval(session, kind, round(1e6 / (hertz * share)))


def publish_telemetry(session: VerbSession, publish: Callable[[str, str, Values], None]) -> None:
    """Have topic, type and values of each message of ROS published that a message of the vehicle makes."""
    system, vehicle = session.vehicle.system, RosVehicle(session.vehicle.component)

    def take(received: Received, now: float) -> None:
        if (received.system, received.component) == (system, vehicle.component):
            made = vehicle.take(received.message, unix_time())
            if made is not None:
                publish(*made)

    session.core.taps.append(take)


def unix_time() -> int:
    """Return the Unix time, us."""
    return time.time_ns() // 1000
