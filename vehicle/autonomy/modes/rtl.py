"""RTL: drives straight to the nearest of home and the rally points, then HOLD."""

from __future__ import annotations

from vehicle.autonomy.mode import ModeContext, ModeFinished
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point
from vehicle.navigation.guidance import STOP_RADIUS, Leg, has_arrived
from vehicle.navigation.rally import ReturnPoint
from vehicle.navigation.speed_control import DesiredMotion


class RtlMode:
    """The return point, chosen when the mode begins, and the line to it."""

    def __init__(self, context: ModeContext) -> None:
        self._params = context.params
        self._guide = context.guide
        self._find_return_point = context.find_return_point
        self._return_point: ReturnPoint | None = None
        self._leg: Leg | None = None

    @property
    def goal(self) -> Point | None:
        """The return point."""
        return self._return_point.point if self._return_point else None

    def unready(self, estimate: Estimate) -> str | None:
        """Return why the mode cannot begin, or None."""
        return None if self._find_return_point(estimate) else "home is not known"

    def begin(self, estimate: Estimate, now: float) -> None:
        """Choose the return point and draw the line to it from here."""
        self._return_point = self._find_return_point(estimate)
        self._leg = Leg(estimate.place, self._return_point.point) if self._return_point else None
        self._guide.reset()

    def step(self, estimate: Estimate, speed: float, now: float) -> DesiredMotion | ModeFinished:
        """Follow the line, at RTL_SPEED if that is set."""
        if self._return_point is None or self._leg is None:
            return ModeFinished("home is not known")
        if has_arrived(self._leg, estimate.place, STOP_RADIUS):
            return ModeFinished(f"{self._return_point.name} is reached")
        return self._guide.follow_leg(self._leg, estimate, self._params["RTL_SPEED"] or speed, 0.0)
