"""`mavhelm turn`: turn on the spot by an angle, as the vehicle's own heading reports it, then neutral."""

from __future__ import annotations

import argparse
import asyncio
import math

from dialects import messages as m
from dialects.axes import NEUTRAL, Axes
from groundstation.verbs.common.arguments import LONGEST_HOLD, finite
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.control.driving import begin_driving, check_driving, leave, need_control
from groundstation.verbs.session.rates import request_interval
from groundstation.verbs.session.reports import need_driven
from groundstation.verbs.session.session import VerbSession

LARGEST = 360.0
"""Degrees."""
PERIOD = 0.02
"""s between looks at the heading."""
HEADINGS = 20.0
"""Hz of ATTITUDE."""
SLOW_WITHIN = 40.0
"""Degrees before the end at which the demand begins to shrink."""
LEAST = 0.3
"""Part of the demand that is left at the end: less does not turn most vehicles."""
TURNS_WITHIN, LEAST_TURN = 2.0, 5.0
"""s and degrees: a vehicle that has turned by less until then does not turn on the spot."""


def angle(text: str) -> float:
    """Parse an angle in degrees. Raises ArgumentTypeError."""
    value = finite(text)
    if not 0 < abs(value) <= LARGEST:
        raise argparse.ArgumentTypeError(f"{text!r} is not an angle from -{LARGEST:g} to {LARGEST:g} degrees")
    return value


def rate(text: str) -> float:
    """Parse a demand. Raises ArgumentTypeError."""
    value = finite(text.removesuffix("%"))
    if not 0 < value <= 100:
        raise argparse.ArgumentTypeError(f"{text!r} is not above 0 and up to 100 %")
    return value


class Turn:
    """A turn by `degrees`, positive to the right. `heading` is that of the start; `demand` is 0 to 1."""

    def __init__(self, degrees: float, demand: float, heading: float) -> None:
        self._degrees, self._demand, self._heading = degrees, demand, heading
        self.turned = 0.0
        """Degrees so far, positive to the right."""

    def update(self, heading: float) -> None:
        """Take the newest heading, degrees; it may not turn by half a turn between two."""
        self.turned += (heading - self._heading + 180.0) % 360.0 - 180.0
        self._heading = heading

    @property
    def left(self) -> float:
        """Degrees still to turn; below 0 once it has turned too far."""
        return math.copysign(1.0, self._degrees) * (self._degrees - self.turned)

    @property
    def axes(self) -> Axes:
        """The demand now."""
        if self.left <= 0:
            return NEUTRAL
        part = max(LEAST, min(1.0, self.left / SLOW_WITHIN))
        return Axes(0.0, math.copysign(self._demand * part, self._degrees))


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Turn; done when the heading has changed by the angle, and neutral was sent."""
    await session.need_only_vehicle(options.vehicle)
    state = session.vehicle
    need_driven(state)
    need_control(session)
    if not state.armed:
        raise VerbError(ExitCode.REFUSED, f"{state.name} is disarmed")
    turn = Turn(options.degrees, options.steering / 100, _heading(session))
    try:
        await _turn(session, turn)
    finally:
        await leave(session, disarm=False)
    turn.update(_heading(session))
    output.note(f"{state.name} has turned by {turn.turned:.0f} degrees, then neutral")
    output.result(True, state.system, turned=round(turn.turned, 1), heading=round(_heading(session), 1))
    return ExitCode.DONE


async def _turn(session: VerbSession, turn: Turn) -> None:
    """Turn. Raises VerbError when the vehicle takes no demands any more, or does not turn."""
    await request_interval(session, m.Attitude, 1e6 / HEADINGS)
    await begin_driving(session)
    operator = session.contact.operator

    def demand(now: float) -> Axes:
        return NEUTRAL if session.core.standstill.last(now) is not None else turn.axes

    operator.inputs.add(began := session.now)
    operator.demand = demand
    while turn.left > 0:
        await asyncio.sleep(PERIOD)
        turn.update(_heading(session))
        check_driving(session, turn.axes, began)
        over = session.now - began
        if over > TURNS_WITHIN and abs(turn.turned) < LEAST_TURN:
            raise VerbError(ExitCode.REFUSED, f"{session.vehicle.name} does not turn on the spot; neutral")
        if over > LONGEST_HOLD:
            text = f"{session.vehicle.name} has turned by {turn.turned:.0f} degrees in {over:.0f} s; neutral"
            raise VerbError(ExitCode.NO_ANSWER, text)


def _heading(session: VerbSession) -> float:
    """Return the heading, degrees. Raises VerbError if the vehicle reports none."""
    heading = session.vehicle.build_view(session.now).heading
    if heading is None:
        raise VerbError(ExitCode.REFUSED, f"{session.vehicle.name} reports no heading")
    return math.degrees(heading)
