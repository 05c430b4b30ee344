"""LOITER: stays within LOIT_RADIUS of the place where it was chosen, and returns if moved away."""

from __future__ import annotations

from vehicle.autonomy.mode import ModeContext
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point
from vehicle.navigation.guidance import STOP_RADIUS, Leg
from vehicle.navigation.speed_control import STATIONARY, DesiredMotion


class LoiterMode:
    """The place to stay at, and whether the rover is on its way back to it."""

    def __init__(self, context: ModeContext) -> None:
        self.goal: Point | None = None
        self._params = context.params
        self._guide = context.guide
        self._returning = False

    def unready(self, estimate: Estimate) -> str | None:
        """Return None: a position is all that LOITER needs, and ModeSpec requires one."""
        return None

    def begin(self, estimate: Estimate, now: float) -> None:
        """Stay at the present place."""
        self.goal = estimate.place
        self._returning = False
        self._guide.reset()

    def step(self, estimate: Estimate, speed: float, now: float) -> DesiredMotion:
        """Stand, or drive back to the middle once the rover is outside LOIT_RADIUS."""
        goal = self.goal or estimate.place
        limit = STOP_RADIUS if self._returning else self._params["LOIT_RADIUS"]
        self._returning = goal.distance(estimate.place) > limit
        if not self._returning:
            return STATIONARY
        return self._guide.follow_leg(Leg(estimate.place, goal), estimate, speed, 0.0)
