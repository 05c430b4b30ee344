"""The modes that end at a place they know: RTL, SMART_RTL by the way it came, and LOITER."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point
from vehicle.navigation.guidance import STOP_RADIUS, Leg, PathFollower, has_arrived
from vehicle.navigation.rally import ReturnPoint
from vehicle.navigation.speed_control import STATIONARY, DesiredMotion
from vehicle.params import Params

TRAIL_SPACING = 1.0
"""m between two points of the trail: finer than the corners this rover can drive around."""
TRAIL_MAX = 500
"""Points; when full, every second one is dropped and the trail gets coarser."""


@dataclass(frozen=True, slots=True)
class ModeFinished:
    """A mode has nothing more to do: HOLD follows."""

    reason: str


class RtlMode:
    """RTL: straight to the nearest of home and the rally points, then HOLD."""

    def __init__(self, params: Params, guide: PathFollower, haven: Callable[[Estimate], ReturnPoint | None]) -> None:
        self._params = params
        self._guide = guide
        self._best = haven
        self._return_point: ReturnPoint | None = None
        self._leg: Leg | None = None

    @property
    def goal(self) -> Point | None:
        """Where it goes; chosen once, when it begins."""
        return self._return_point.point if self._return_point else None

    def unready(self, estimate: Estimate) -> str | None:
        """Why it cannot begin."""
        return None if self._best(estimate) else "home is not known"

    def begin(self, estimate: Estimate, now: float) -> None:
        """From here."""
        self._return_point = self._best(estimate)
        self._leg = Leg(estimate.place, self._return_point.point) if self._return_point else None
        self._guide.reset()

    def step(self, estimate: Estimate, speed: float, now: float) -> DesiredMotion | ModeFinished:
        """On the line."""
        if self._return_point is None or self._leg is None:
            return ModeFinished("home is not known")
        if has_arrived(self._leg, estimate.place, STOP_RADIUS):
            return ModeFinished(f"{self._return_point.name} is reached")
        return self._guide.follow_leg(self._leg, estimate, self._params["RTL_SPEED"] or speed, 0.0)


class Trail:
    """Where the rover was since it was armed, without the loops it drove."""

    def __init__(self) -> None:
        self.points: list[Point] = []
        self._spacing = TRAIL_SPACING

    def clear(self) -> None:
        """A new drive begins."""
        self.points.clear()
        self._spacing = TRAIL_SPACING

    def add(self, place: Point) -> None:
        """The rover is here now."""
        if self.points and self.points[-1].distance(place) < self._spacing:
            return
        near = next((index for index, point in enumerate(self.points) if point.distance(place) < self._spacing), None)
        if near is not None:  # it was here before: what lies between was a loop
            del self.points[near + 1 :]
            return
        self.points.append(place)
        if len(self.points) > TRAIL_MAX:
            del self.points[1::2]
            self._spacing *= 2


class SmartRtlMode:
    """SMART_RTL: back along the trail, then HOLD."""

    def __init__(self, params: Params, guide: PathFollower, trail: Trail) -> None:
        self.goal: Point | None = None
        self._params = params
        self._guide = guide
        self._trail = trail
        self._way: list[Point] = []
        self._leg: Leg | None = None

    def unready(self, estimate: Estimate) -> str | None:
        """Why it cannot begin."""
        return None if self._trail.points else "no trail was recorded"

    def begin(self, estimate: Estimate, now: float) -> None:
        """From here; the way is a copy, for what is driven on the way back is trail too."""
        self._way = list(self._trail.points)
        self.goal = self._way[0] if self._way else None
        self._leg = None
        self._guide.reset()

    def step(self, estimate: Estimate, speed: float, now: float) -> DesiredMotion | ModeFinished:
        """On to the next point of the trail."""
        while self._leg is None or has_arrived(
            self._leg, estimate.place, TRAIL_SPACING / 2 if self._way else STOP_RADIUS
        ):
            if not self._way:
                return ModeFinished("the start is reached")
            start = self._leg.end if self._leg else estimate.place
            self._leg = Leg(start, self._way.pop())
        speed = self._params["RTL_SPEED"] or speed
        return self._guide.follow_leg(self._leg, estimate, speed, self._corner(self._leg, speed))

    def _corner(self, leg: Leg, speed: float) -> float:
        if not self._way:
            return 0.0
        return self._guide.corner_speed(abs(leg.bearing - Leg(leg.end, self._way[-1]).bearing), speed)


class LoiterMode:
    """LOITER: stays within LOIT_RADIUS of where it was chosen, and drives back when it was moved away."""

    def __init__(self, params: Params, guide: PathFollower) -> None:
        self.goal: Point | None = None
        self._params = params
        self._guide = guide
        self._returning = False

    def unready(self, estimate: Estimate) -> str | None:
        """A position is all it needs, and the mode asks for that."""
        return None

    def begin(self, estimate: Estimate, now: float) -> None:
        """Here."""
        self.goal = estimate.place
        self._returning = False
        self._guide.reset()

    def step(self, estimate: Estimate, speed: float, now: float) -> DesiredMotion:
        """Stand, or go back to the middle."""
        goal = self.goal or estimate.place
        away = goal.distance(estimate.place)
        self._returning = away > (STOP_RADIUS if self._returning else self._params["LOIT_RADIUS"])
        return (
            self._guide.follow_leg(Leg(estimate.place, goal), estimate, speed, 0.0) if self._returning else STATIONARY
        )
