"""SMART_RTL: drives back along the recorded trail, then HOLD."""

from __future__ import annotations

from vehicle.autonomy.mode import ModeContext, ModeFinished
from vehicle.autonomy.trail import TRAIL_SPACING
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point
from vehicle.navigation.guidance import STOP_RADIUS, Leg, has_arrived
from vehicle.navigation.speed_control import DesiredMotion


class SmartRtlMode:
    """The points of the trail that are still to be driven."""

    def __init__(self, context: ModeContext) -> None:
        self.goal: Point | None = None
        self._params = context.params
        self._guide = context.guide
        self._trail = context.trail
        self._remaining: list[Point] = []
        self._leg: Leg | None = None

    def unready(self, estimate: Estimate) -> str | None:
        """Return why the mode cannot begin, or None."""
        return None if self._trail.points else "no trail was recorded"

    def begin(self, estimate: Estimate, now: float) -> None:
        """Begin at the newest point of a copy of the trail: the way back changes the trail itself."""
        self._remaining = list(self._trail.points)
        self.goal = self._remaining[0] if self._remaining else None
        self._leg = None
        self._guide.reset()

    def step(self, estimate: Estimate, speed: float, now: float) -> DesiredMotion | ModeFinished:
        """Follow the line to the next point of the trail, at RTL_SPEED if that is set."""
        while self._leg is None or self._has_arrived(self._leg, estimate.place):
            if not self._remaining:
                return ModeFinished("the start is reached")
            start = self._leg.end if self._leg else estimate.place
            self._leg = Leg(start, self._remaining.pop())
        speed = self._params["RTL_SPEED"] or speed
        return self._guide.follow_leg(self._leg, estimate, speed, self._corner_speed(self._leg, speed))

    def _has_arrived(self, leg: Leg, place: Point) -> bool:
        return has_arrived(leg, place, TRAIL_SPACING / 2 if self._remaining else STOP_RADIUS)

    def _corner_speed(self, leg: Leg, speed: float) -> float:
        if not self._remaining:
            return 0.0
        return self._guide.corner_speed(abs(leg.bearing - Leg(leg.end, self._remaining[-1]).bearing), speed)
