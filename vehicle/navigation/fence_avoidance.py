"""The fence as the rover meets it: is it beyond, may it go there, and how fast may it still go toward the edge.

As in ArduRover, what drives by itself stops FENCE_MARGIN before the fence (AVOID_ENABLE); a breach, which then takes a
driver or a bad position, is vehicle/safety/failsafe.py's.
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
"""s between two looks; at 1.5 m/s a rover is 15 cm beyond by then."""
STUCK_TIMEOUT = 3.0
"""s that a place is driven for, standing before the fence."""


class FenceAvoidance:
    """`sense` each cycle; then `before` for what drives by itself."""

    def __init__(self, params: Params, home: Callable[[], Point | None]) -> None:
        self.fence = Fence(params)
        self.breach_distance = 0.0
        """m beyond the fence."""
        self.breach_count = 0
        """How often the rover has gone beyond it."""
        self.breached_at: float | None = None
        """When it did so last."""
        self.is_limiting = False
        """The fence ahead makes it slower than it wants."""
        self._params = params
        self._home = home
        self._estimate = Estimate()
        self._due = -math.inf
        self._room = math.inf
        self._stands_since: float | None = None

    @property
    def lacks_position(self) -> bool:
        """There is a line that nobody may cross, and the rover does not know where it is."""
        return self.fence.has_boundary and not self._estimate.good

    @property
    def unenforceable_reason(self) -> str | None:
        """Why a fence that counts would stop nobody, or None: it is lost, or the rover does not know where it is."""
        lost = self.fence.unavailable_reason
        if lost is None and self.lacks_position:
            return "position is not known, and the fence needs it; wait, or set FENCE_ENABLE 0"
        return lost

    def update(self, estimate: Estimate, now: float) -> None:
        """Where the rover is now."""
        self._estimate = estimate
        if now < self._due:
            return
        self._due = now + PERIOD
        self._room = self._room_at(estimate.place) if estimate.good else math.inf
        before, self.breach_distance = self.breach_distance, max(0.0, -self._room)
        if self.breach_distance and not before:
            self.breach_count, self.breached_at = self.breach_count + 1, now

    def breach_distance_at(self, place: Point) -> float:
        """m that a place lies beyond the fence; 0 within."""
        return max(0.0, -self._room_at(place))

    def rejection(self, place: Point) -> str | None:
        """Why the fence forbids to drive to a place, or None."""
        room = self._room_at(place)
        if room < 0.0:
            return "it lies beyond the fence"
        return "it lies nearer to the fence than FENCE_MARGIN" if room < self._margin else None

    def block_reason(self, *, homeward: bool) -> str | None:
        """Why nothing drives by itself: beyond the fence it goes home at most, and not from far."""
        if self.breach_distance > BREACH_DISTANCE_MAX or (
            self.breach_distance and not homeward and self._params["FENCE_ACTION"]
        ):
            return f"{self.breach_distance:.0f} m beyond the fence"
        return None

    def limit_speed(self, wanted: DesiredMotion, now: float) -> DesiredMotion:
        """What is wanted, no faster than it can stop FENCE_MARGIN before the fence. Beyond it the way back is free."""
        fastest = self._fastest(wanted.speed)
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
        """Nothing drives by itself."""
        self.is_limiting, self._stands_since = False, None

    def is_stuck(self, now: float) -> bool:
        """It has stood before the fence for too long to go on waiting."""
        return self._stands_since is not None and now - self._stands_since >= STUCK_TIMEOUT

    @property
    def _margin(self) -> float:
        """m to keep from the fence."""
        return self._params["FENCE_MARGIN"] if self._params["AVOID_ENABLE"] else 0.0

    def _room_at(self, place: Point) -> float:
        return self.fence.distance_to_edge(place, self._estimate.origin, self._home())

    def _fastest(self, speed: float) -> float:
        """m/s that the fence allows in the direction of `speed`."""
        params, estimate = self._params, self._estimate
        avoids = params["AVOID_ENABLE"] and params["FENCE_ACTION"] and estimate.good and not self.breach_distance
        twice_braking = 2.0 * params["ATC_DECEL_MAX"]
        reach = self._margin + speed * speed / twice_braking + abs(speed) * PERIOD
        if not avoids or estimate.yaw is None or self._room > reach:
            return math.inf
        course = estimate.yaw + (math.pi if speed < 0.0 else 0.0)
        ahead = self.fence.distance_ahead(estimate.place, course, estimate.origin, self._home())
        return math.sqrt(twice_braking * max(0.0, ahead - self._margin))
