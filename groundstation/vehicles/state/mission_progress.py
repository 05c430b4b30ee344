"""Progress of a vehicle's mission: MISSION_CURRENT, NAV_CONTROLLER_OUTPUT, and the plan if it was downloaded."""

from __future__ import annotations

import math
from itertools import pairwise

import msgspec

from dialects import messages as m
from dialects.enum_names import enum_names
from groundstation.geo import Place, find_separation
from groundstation.snapshot.drive import MissionProgress
from groundstation.vehicles.state.vehicle_details import to_place
from link.services.mission.items import GLOBAL_FRAMES, Items, MissionItem

NO_MISSION = 0xFFFF
"""`total` of MISSION_CURRENT; 0: not reported."""

FRESH = 3.0
"""s for which a NAV_CONTROLLER_OUTPUT counts."""

STANDS = 0.1
"""m/s below which the time to go is not known."""

MAX_LEGS = 40
"""Legs in a snapshot: more cannot be told apart on a line of the screen."""


class _Route(msgspec.Struct, frozen=True):
    """The items of a plan that have a place."""

    places: tuple[tuple[int, Place], ...] = ()
    """Sequence number and place."""
    legs: tuple[float, ...] = ()
    """Lengths of the legs between them, m."""

    @classmethod
    def of(cls, plan: Items) -> _Route:
        found = tuple((number, place) for number, item in enumerate(plan) if (place := _place(item)) is not None)
        return cls(found, tuple(_distance(one, other) for (_, one), (_, other) in pairwise(found)))

    def ahead(self, seq: int) -> tuple[Place | None, float]:
        """Return the next place from an item on, and the way from there to the end."""
        for index, (number, place) in enumerate(self.places):
            if number >= seq:
                return place, sum(self.legs[index:])
        return None, 0.0


class MissionMessages:
    """The newest messages about the mission of one vehicle."""

    def __init__(self) -> None:
        self._current: m.MissionCurrent | None = None
        self._navigation: m.NavControllerOutput | None = None
        self._navigated_at = -math.inf
        self._plan: Items = ()
        self._route = _Route()

    def receive(self, message: m.Message, now: float) -> None:
        """Handle a message of the autopilot."""
        if isinstance(message, m.MissionCurrent):
            self._current = message
        elif isinstance(message, m.NavControllerOutput):
            self._navigation, self._navigated_at = message, now

    def build(
        self, plan: Items, here: Place | None, speed: float | None, *, navigates: bool, now: float
    ) -> MissionProgress | None:
        """Build the part of the snapshot; None without a mission. `navigates`: the vehicle drives to the item."""
        current = self._current
        if current is None or current.total == NO_MISSION or not (plan or current.total):
            return None
        if plan is not self._plan:
            self._plan, self._route = plan, _Route.of(plan)
        goal, rest = self._route.ahead(current.seq)
        way = find_separation(here, goal)
        distance = way.distance if way is not None else self._reported_distance(now) if navigates else None
        left = distance + rest if distance is not None and goal is not None else None
        return MissionProgress(
            current=int(current.seq),
            last=len(plan) - 1 if plan else int(current.total) - 1,
            command=item_text(plan[current.seq]) if current.seq < len(plan) else "",
            distance=distance,
            legs=tuple(round(leg, 1) for leg in self._route.legs[:MAX_LEGS]),
            places=tuple(number for number, _ in self._route.places[1 : MAX_LEGS + 1]),
            left=left,
            time_left=left / speed if left is not None and navigates and speed is not None and speed > STANDS else None,
        )

    def _reported_distance(self, now: float) -> float | None:
        if self._navigation is None or now - self._navigated_at > FRESH:
            return None
        return float(self._navigation.wp_dist)


def item_text(item: MissionItem) -> str:
    """Return an item in words: its command, and the seconds that it waits."""
    name = enum_names("MAV_CMD").get(item.command, f"command {item.command}").removeprefix("NAV_")
    wait = item.params[0] if name in ("LOITER_TIME", "DELAY", "WAYPOINT") else math.nan
    return f"{name} {wait:g} s" if math.isfinite(wait) and wait > 0 else name


def _place(item: MissionItem) -> Place | None:
    return to_place(item.x, item.y) if item.frame in GLOBAL_FRAMES else None


def _distance(one: Place, other: Place) -> float:
    way = find_separation(one, other)
    return 0.0 if way is None else way.distance
