"""Items for the tests of the Map screen."""

from __future__ import annotations

from groundstation.geo import LocalFrame, Place
from groundstation.views.plan import PlanItem

HOME = Place(-35.3632621, 149.1652374)
AROUND = LocalFrame(HOME)


def at(north: float, east: float) -> Place:
    """A place so many metres from home."""
    return AROUND.to_place((north, east))


def item(command: int = 16, north: float = 0.0, east: float = 0.0, *params: float, frame: int = 3) -> PlanItem:
    """An item at a place."""
    place = at(north, east)
    one, two, three, four = (*params, *(0.0,) * (4 - len(params)))
    return PlanItem(command, frame, (one, two, three, four), round(place.latitude * 1e7), round(place.longitude * 1e7),
                    0.0)  # fmt: skip


def task(command: int, *params: float) -> PlanItem:
    """An item without a place."""
    one, two, three, four = (*params, *(0.0,) * (4 - len(params)))
    return PlanItem(command, 2, (one, two, three, four), 0, 0, 0.0)


def square(half: float, command: int = 5001) -> tuple[PlanItem, ...]:
    """A fence around home."""
    corners = ((half, -half), (half, half), (-half, half), (-half, -half))
    return tuple(item(command, north, east, 4.0) for north, east in corners)
