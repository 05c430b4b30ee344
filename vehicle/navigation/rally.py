"""Return points for RTL: the nearest of home and the rally points (RALLY_LIMIT_KM, RALLY_INCL_HOME).

The rules are ArduRover's.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from link.services.mission.items import Items
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point
from vehicle.params import Params

METERS_PER_KM = 1000.0


class ReturnPoint(NamedTuple):
    """A place to return to."""

    point: Point
    name: str
    """Name in a STATUSTEXT."""


class ReturnPoints:
    """Home and the rally points."""

    def __init__(self, params: Params, home: Callable[[], Point | None], breach: Callable[[Point], float]) -> None:
        """Create the return points.

        `breach` returns the m that a place lies outside the fence: a rally point there is ignored.
        """
        self._params = params
        self._home = home
        self._breach = breach
        self._items: Items = ()

    def load(self, items: Items) -> None:
        """Use other rally points that have passed the rules of vehicle/autonomy/mission/rules.py."""
        self._items = items

    def nearest(self, estimate: Estimate) -> ReturnPoint | None:
        """Return the nearest point; None if there is neither home nor a rally point.

        Home counts if RALLY_INCL_HOME is set, and if no rally point is within RALLY_LIMIT_KM (0: any distance).
        """
        home, rally = self._home(), self._nearest_rally(estimate)
        if home is None or rally is None:
            return rally if home is None else ReturnPoint(home, "home")
        nearer = estimate.place.distance(home) <= estimate.place.distance(rally.point)
        return ReturnPoint(home, "home") if nearer and self._params["RALLY_INCL_HOME"] else rally

    def _nearest_rally(self, estimate: Estimate) -> ReturnPoint | None:
        if estimate.origin is None:
            return None
        points = [estimate.origin.to_local(item.latitude, item.longitude) for item in self._items]
        within = [point for point in points if not self._breach(point)]
        point = min(within, key=estimate.place.distance, default=None)
        limit = self._params["RALLY_LIMIT_KM"] * METERS_PER_KM
        if point is None or (limit and estimate.place.distance(point) > limit):
            return None
        return ReturnPoint(point, f"rally point {points.index(point)}")
