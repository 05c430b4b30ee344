"""Fence breaches, and fence avoidance: autonomous motion slows down and stops before the fence.

As in ArduRover, autonomous modes stop FENCE_MARGIN before the fence (AVOID_ENABLE). A breach then needs an operator or
a bad position; vehicle/safety/failsafe.py defines what follows.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from vehicle.navigation.estimate import Estimate
from vehicle.navigation.fence import BREACH_DISTANCE_MAX, Fence
from vehicle.navigation.geo import Point
from vehicle.navigation.speed_control import DesiredMotion
from vehicle.params import Params

PERIOD = 0.1
"""s between two checks; at 1.5 m/s a rover moves 15 cm in that time."""
AVOID_FENCE = 1
"""Bit of AVOID_ENABLE (ArduPilot: UseFence)."""
STUCK_TIMEOUT = 3.0
"""s at a standstill before the fence after which the target counts as unreachable."""


class FenceAvoidance:
    """Call `update` in each cycle, then `limit_speed` for autonomous motion."""

    def __init__(self, params: Params, home: Callable[[], Point | None]) -> None:
        self.fence = Fence(params)
        self.breach_distance = 0.0
        """m outside the fence; 0 inside."""
        self.breach_count = 0
        """Number of breaches."""
        self.breached_at: float | None = None
        """Time of the last breach."""
        self.is_limiting = False
        """The fence ahead limits the speed."""
        self._params = params
        self._home = home
        self._estimate = Estimate()
        self._due = -math.inf
        self._distance = math.inf
        self._stands_since: float | None = None

    @property
    def lacks_position(self) -> bool:
        """The fence has a boundary, and the position is not known."""
        return self.fence.has_boundary and not self._estimate.good

    @property
    def unenforceable_reason(self) -> str | None:
        """Why the enabled fence cannot be enforced, or None: its plan is lost, or the position is unknown."""
        lost = self.fence.unavailable_reason
        if lost is None and self.lacks_position:
            return "the fence requires a position; wait, or set FENCE_ENABLE 0"
        return lost

    def update(self, estimate: Estimate, now: float) -> None:
        """Check the position against the fence."""
        self._estimate = estimate
        if now < self._due:
            return
        self._due = now + PERIOD
        self._distance = self._distance_at(estimate.place) if estimate.good else math.inf
        before, self.breach_distance = self.breach_distance, max(0.0, -self._distance)
        if self.breach_distance and not before:
            self.breach_count, self.breached_at = self.breach_count + 1, now

    def breach_distance_at(self, place: Point) -> float:
        """Return the m that a place lies outside the fence; 0 inside."""
        return max(0.0, -self._distance_at(place))

    def rejection(self, place: Point) -> str | None:
        """Return why the fence forbids to drive to a place, or None."""
        distance = self._distance_at(place)
        if distance < 0.0:
            return "outside the fence"
        return "closer to the fence than FENCE_MARGIN" if distance < self._margin else None

    def block_reason(self, *, homeward: bool) -> str | None:
        """Return why an autonomous mode may not drive, or None.

        Outside the fence only the modes that lead home may drive, and only up to BREACH_DISTANCE_MAX.
        """
        if self.breach_distance > BREACH_DISTANCE_MAX or (
            self.breach_distance and not homeward and self._params["FENCE_ACTION"]
        ):
            return f"{self.breach_distance:.0f} m outside the fence"
        return None

    def limit_speed(self, wanted: DesiredMotion, now: float) -> DesiredMotion:
        """Return the motion, slow enough to stop FENCE_MARGIN before the fence. Outside, the way back is free."""
        fastest = self._allowed_speed(wanted.speed)
        self.is_limiting = abs(wanted.speed) > fastest
        if not self.is_limiting:
            self._stands_since = None
            return wanted
        if fastest >= self._params["ATC_STOP_SPEED"]:
            self._stands_since = None
            return wanted._replace(speed=math.copysign(fastest, wanted.speed))
        if self._stands_since is None:
            self._stands_since = now
        return wanted._replace(speed=0.0)

    def reset(self) -> None:
        """Reset the limit: no autonomous mode drives."""
        self.is_limiting, self._stands_since = False, None

    def is_stuck(self, now: float) -> bool:
        """Return True after STUCK_TIMEOUT at a standstill before the fence."""
        return self._stands_since is not None and now - self._stands_since >= STUCK_TIMEOUT

    @property
    def _avoids_fence(self) -> bool:
        return bool(int(self._params["AVOID_ENABLE"]) & AVOID_FENCE)

    @property
    def _margin(self) -> float:
        """Distance to keep from the fence, m."""
        return self._params["FENCE_MARGIN"] if self._avoids_fence else 0.0

    def _distance_at(self, place: Point) -> float:
        return self.fence.distance_to_edge(place, self._estimate.origin, self._home())

    def _allowed_speed(self, speed: float) -> float:
        """Return the m/s that the fence allows in the direction of `speed`."""
        params, estimate = self._params, self._estimate
        avoids = self._avoids_fence and params["FENCE_ACTION"] and estimate.good and not self.breach_distance
        twice_braking = 2.0 * params["ATC_DECEL_MAX"]
        reach = self._margin + speed * speed / twice_braking + abs(speed) * PERIOD
        if not avoids or estimate.yaw is None or self._distance > reach:
            return math.inf
        course = estimate.yaw + (math.pi if speed < 0.0 else 0.0)
        ahead = self.fence.distance_ahead(estimate.place, course, estimate.origin, self._home())
        return math.sqrt(twice_braking * max(0.0, ahead - self._margin))
