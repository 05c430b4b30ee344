"""How long a mission takes: the ways at the speed that the vehicle drives in AUTO, and the times that it waits."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec

from groundstation.geo import Point
from groundstation.ui.map.plan.commands import CHANGE_SPEED, WAYPOINT
from groundstation.views.plan import PlanItem

LOITER_UNLIMITED, LOITER_TURNS, LOITER_TIME, DELAY, CONDITION_DELAY = 17, 18, 19, 93, 112
WAITS = (WAYPOINT, LOITER_TIME, DELAY, CONDITION_DELAY)
"""Commands whose first parameter is a time, s."""


class LegTime(msgspec.Struct, frozen=True):
    """What the way to a place of the mission takes beside its length."""

    speed: float
    """m/s."""
    wait: float
    """s of waiting and circling there, inf where the vehicle stays."""


def leg_times(items: Sequence[PlanItem], indices: Sequence[int], speed: float | None) -> tuple[LegTime, ...] | None:
    """Return the times of the items with a place (`indices`); None while a speed is not known.

    `speed` is that of AUTO, m/s. DO_CHANGE_SPEED holds from its item on; DO_JUMP is left out, as in the length.
    """
    legs, now, places = [], speed, set(indices)
    wait = 0.0
    for index, item in enumerate(items):
        if item.command == CHANGE_SPEED:
            asked = item.params[1]
            now = asked if asked > 0 else speed if asked == -2 else now
            continue
        wait += _wait(item, now)
        if index in places:
            if now is None or not now > 0:
                return None
            legs.append(LegTime(now, wait))
            wait = 0.0
    return tuple(legs)


def _wait(item: PlanItem, speed: float | None) -> float:
    """Return the s for which an item keeps the vehicle where it is."""
    first = item.params[0]
    if item.command == LOITER_UNLIMITED:
        return math.inf
    if item.command in WAITS:
        return first if math.isfinite(first) and first > 0 else 0.0
    if item.command == LOITER_TURNS and speed and math.isfinite(way := first * item.params[2]):
        return math.tau * abs(way) / speed
    return 0.0


def seconds_of(start: Point | None, points: Sequence[Point], legs: Sequence[LegTime]) -> float | None:
    """Return the s from a point over all places; None where the vehicle stays at one of them."""
    seconds, before = 0.0, start
    for point, leg in zip(points, legs, strict=True):
        seconds += (math.dist(before, point) / leg.speed if before is not None else 0.0) + leg.wait
        before = point
    return seconds if math.isfinite(seconds) else None


def clock_text(seconds: float) -> str:
    """Return a time as minutes and seconds, or with hours."""
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02}" if minutes < 60 else f"{minutes // 60}:{minutes % 60:02}:{rest:02}"
