"""The geofence: a circle around home and the areas of the fence plan.

vehicle/safety/failsafe.py defines what follows from a breach.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from dialects.enums import FenceItem
from link.services.mission.items import Items
from vehicle.navigation.fence_area import FenceArea
from vehicle.navigation.geo import Origin, Point
from vehicle.params import Params

POLYGONS = (FenceItem.POLYGON_INCLUSION, FenceItem.POLYGON_EXCLUSION)
CIRCLE, AREAS = 2, 4
"""Bits of FENCE_TYPE, as in ArduPilot."""
BREACH_DISTANCE_MAX = 100.0
"""m outside the fence beyond which no autonomous mode may start: the position itself is in doubt."""


class Fence:
    """The fence. The rover must be inside every inclusion and outside every exclusion, as in ArduPilot."""

    def __init__(self, params: Params) -> None:
        self.damage: str | None = None
        """Why the stored fence is lost: its areas are unknown, so that it cannot be enforced."""
        self._params = params
        self._items: Items = ()
        """The items that define the areas."""
        self._areas: list[FenceArea] = []
        self._origin: Origin | None = None

    @property
    def enabled(self) -> bool:
        """The fence is enabled (FENCE_ENABLE)."""
        return bool(self._params["FENCE_ENABLE"])

    @property
    def is_present(self) -> bool:
        """The fence is enabled, or areas were uploaded."""
        return self.enabled or bool(self._items)

    @property
    def unavailable_reason(self) -> str | None:
        """Why the enabled fence forbids driving, or None."""
        return f"{self.damage}, upload it again or set FENCE_ENABLE 0" if self.enabled and self.damage else None

    @property
    def has_boundary(self) -> bool:
        """The fence is enabled and has a boundary."""
        kinds = int(self._params["FENCE_TYPE"])
        return self.enabled and bool(kinds & CIRCLE or (kinds & AREAS and self._items))

    def set_enabled(self, enabled: bool) -> str | None:
        """Enable or disable the fence; return why that is refused: the configuration file sets FENCE_ENABLE."""
        if enabled != self.enabled and "FENCE_ENABLE" in self._params.pinned:
            return f"the configuration file sets FENCE_ENABLE {int(self.enabled)}"
        self._params.set("FENCE_ENABLE", float(enabled))
        return None

    def load(self, items: Items, damage: str | None = None) -> None:
        """Use another fence plan that has passed the rules of vehicle/autonomy/mission/rules.py.

        `damage`: why the stored plan is lost.
        """
        self._items = tuple(item for item in items if item.command != FenceItem.RETURN_POINT)
        self.damage = damage
        self._origin = None

    def distance_to_edge(self, place: Point, origin: Origin | None, home: Point | None) -> float:
        """Return the m to the nearest edge, negative outside; infinite without one."""
        return min((area.distance_to_edge(place) for area in self._in_force(origin, home)), default=math.inf)

    def distance_ahead(self, place: Point, course: float, origin: Origin | None, home: Point | None) -> float:
        """Return the m to the first edge on a course; infinite without one."""
        return min((area.distance_ahead(place, course) for area in self._in_force(origin, home)), default=math.inf)

    def _in_force(self, origin: Origin | None, home: Point | None) -> Iterator[FenceArea]:
        if not self.enabled or origin is None:
            return
        kinds = int(self._params["FENCE_TYPE"])
        if kinds & CIRCLE and home is not None:
            yield FenceArea((home,), self._params["FENCE_RADIUS"], inclusion=True)
        if kinds & AREAS:
            yield from self._areas_on(origin)

    def _areas_on(self, origin: Origin) -> list[FenceArea]:
        """Return the areas in metres, computed once for an origin."""
        if origin != self._origin:
            self._origin = origin
            self._areas = _areas(self._items, origin)
        return self._areas


def find_ineffective_items(items: Items) -> list[str]:
    """Return notices about items without effect: as in ArduRover, nothing drives to a return point."""
    if any(item.command == FenceItem.RETURN_POINT for item in items):
        return ["Fence: return point stored but not used; FENCE_ACTION selects the action"]
    return []


def _areas(items: Items, origin: Origin) -> list[FenceArea]:
    found, index = [], 0
    while index < len(items):
        item = items[index]
        size = int(item.params[0]) if item.command in POLYGONS else 1
        corners = tuple(origin.to_local(each.latitude, each.longitude) for each in items[index : index + size])
        radius = 0.0 if item.command in POLYGONS else item.params[0]
        inside = item.command in (FenceItem.POLYGON_INCLUSION, FenceItem.CIRCLE_INCLUSION)
        found.append(FenceArea(corners, radius, inside))
        index += size
    return found
