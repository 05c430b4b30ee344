"""How far the rover still drives once its motors begin to fall, and how fast it may be to stop within a distance."""

from __future__ import annotations

import math
from typing import NamedTuple

from vehicle.params import Params

REACTION_TIME = 0.06
"""s until the motors begin to fall: three cycles, of which one may be late and one has just been computed."""


class Stopping(NamedTuple):
    """The way to a standstill: the motors fall by their ramp, and the wheels follow them with a lag."""

    lag: float
    """s for which the rover goes on at its speed: reaction, motors and gears."""
    braking: float
    """m/s2 of the ramp (MOT_DECEL), or of `slowest` where the wheels cannot follow it."""

    @classmethod
    def of(cls, params: Params, slowest: float = 0.0) -> Stopping:
        """Return it for these parameters; with `slowest` above 0 the rover brakes with that many m/s2 at most."""
        ramp = params["MOT_DECEL"] / 100 * params["SPEED_MAX"]
        return cls(REACTION_TIME + params["STOP_LAG"], min(ramp, slowest) if slowest > 0.0 else ramp)

    def distance(self, speed: float) -> float:
        """Return the m from `speed` m/s to a standstill.

        Of a lag of the first order this is exact: what the wheels drive beyond the ramp is their speed times the lag.
        """
        return speed * self.lag + speed * speed / (2.0 * self.braking)

    def speed_within(self, distance: float) -> float:
        """Return the m/s from which the rover stops within `distance` m; 0 if there is no room."""
        if not distance > 0.0:
            return 0.0
        slowing = self.lag * self.braking
        return math.sqrt(slowing * slowing + 2.0 * self.braking * distance) - slowing
