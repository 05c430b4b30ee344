"""A driver's demand as the two messages that carry one say it: MANUAL_CONTROL and RC_CHANNELS_OVERRIDE."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from dialects import axes
from dialects.messages import ManualControl, RcChannelsOverride

STEERING_CHANNEL, THROTTLE_CHANNEL = 1, 3
"""ArduRover's default RCMAP."""
PULSE_NEUTRAL, PULSE_DEADZONE, PULSE_SPAN = 1500, 30, 400
"""us: ArduRover's trim, dead zone and distance to full deflection (1100..1900, RC_Channel.cpp)."""
PULSE_MIN, PULSE_MAX = 800, 2200
"""us: anything else is no pulse of a radio."""


class Demand(NamedTuple):
    """What a driver asks for. None on an axis is "no demand there": neutral, but no proof of a stick at rest."""

    throttle: float | None
    steering: float | None
    time: float
    """When its oldest part arrived."""
    system: int
    sequence: int
    """Packet sequence number of the message."""
    sideways: float | None = None
    """To the right, of vehicles that can; the others and most drivers have no such stick."""
    direct: bool = False
    """Made by the vehicle's own controllers: no dead band and no softness."""

    def is_neutral(self, band: float) -> bool:
        """All sticks are at rest."""
        throttle, steering = self.throttle, self.steering
        if throttle is None or steering is None:
            return False
        return abs(throttle) <= band and abs(steering) <= band and abs(self.sideways or 0.0) <= band

    def requests_motion(self, band: float) -> bool:
        """Any stick asks for motion."""
        return abs(self.throttle or 0.0) > band or abs(self.steering or 0.0) > band or abs(self.sideways or 0.0) > band


def from_manual_control(
    message: ManualControl, system: int, sequence: int, now: float, *, sideways: bool = False
) -> Demand | None:
    """The demand of a MANUAL_CONTROL; None where no axis of ours is valid. Axes: dialects/axes.py.

    `sideways`: this vehicle can, and y, which the specification calls roll, asks for it.
    """
    throttle, steering = axes.parse_manual_control(message)
    side = message.y / axes.FULL_DEFLECTION if sideways and abs(message.y) <= axes.FULL_DEFLECTION else None
    if throttle is None and steering is None and side is None:
        return None
    return Demand(throttle, steering, now, system, sequence, side)


@dataclass(frozen=True, slots=True)
class OverrideChannel:
    """One overridden channel."""

    pulse: int
    """us"""
    time: float


class RcOverride:
    """The channels that RC_CHANNELS_OVERRIDE holds; each is given back or goes stale by itself."""

    COUNT = 18

    def __init__(self) -> None:
        self.channels: dict[int, OverrideChannel] = {}
        """Channel 1..18 -> what holds it."""
        self.has_invalid_value = False
        """The newest message had a value that is neither a pulse nor one of the special numbers."""

    def update(self, message: RcChannelsOverride, now: float) -> bool:
        """Take a message; True where it speaks of throttle or steering (setting them or giving them back)."""
        self.has_invalid_value = False
        spoken = [self._set(number, getattr(message, f"chan{number}_raw"), now) for number in range(1, self.COUNT + 1)]
        return spoken[THROTTLE_CHANNEL - 1] or spoken[STEERING_CHANNEL - 1]

    def build_demand(self, system: int, sequence: int, now: float, timeout: float) -> Demand:
        """Throttle and steering of the channels that are not older than `timeout` s.

        Steering that nobody holds is at rest, because MAVProxy's `rc 3 1500` holds the throttle only.
        """
        throttle, steering = (self._fresh(number, now, timeout) for number in (THROTTLE_CHANNEL, STEERING_CHANNEL))
        # A channel that moves the rover must not live longer because the other one was repeated.
        oldest = min((each.time for each in (throttle, steering) if each and deflection(each.pulse)), default=now)
        return Demand(
            deflection(throttle.pulse) if throttle else None,
            deflection(steering.pulse) if steering else 0.0,
            oldest,
            system,
            sequence,
        )

    def _fresh(self, number: int, now: float, timeout: float) -> OverrideChannel | None:
        channel = self.channels.get(number)
        return channel if channel and now - channel.time <= timeout else None

    def _set(self, number: int, value: int, now: float) -> bool:
        if value == 65535 or (number > 8 and value == 0):
            return False
        if value == (0 if number <= 8 else 65534):
            self.channels.pop(number, None)
            return True
        if not PULSE_MIN <= value <= PULSE_MAX:
            self.has_invalid_value = True
            return False
        self.channels[number] = OverrideChannel(value, now)
        return True


def deflection(pulse: int) -> float:
    """A pulse in us as -1..1."""
    offset = pulse - PULSE_NEUTRAL
    if abs(offset) <= PULSE_DEADZONE:
        return 0.0
    beyond = (abs(offset) - PULSE_DEADZONE) / (PULSE_SPAN - PULSE_DEADZONE)
    return math.copysign(min(1.0, beyond), offset)


def pulse(value: float) -> int:
    """-1..1 as a pulse in us: what a radio or servo of that deflection would show."""
    return PULSE_NEUTRAL + round(value * PULSE_SPAN)
