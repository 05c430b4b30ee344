"""Views of the Map screen: a park with a mission that is half driven, a fence and a rally point."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import msgspec

from groundstation.snapshot import Snapshot
from groundstation.views.base import View
from groundstation.views.plan import (
    Neighbour,
    PlanItem,
    PlanKind,
    PlanMode,
    PlanPage,
    PlanSummary,
    PlanTrackView,
    PlanView,
)
from groundstation.views.requests import RequestLine
from tests.groundstation.ui.examples import snapshot, vehicle
from tests.groundstation.ui.map.plans import HOME, at, item, task

MISSION = (
    item(16, 12.0, 5.0),
    item(16, 52.0, 12.0),
    item(16, 52.0, 30.0),
    task(178, 1.0, 0.6),
    item(16, 9.0, 28.0),
    item(16, 9.0, 48.0),
    item(19, 46.0, 50.0, 10.0),
    item(16, 46.0, 68.0),
    item(16, 8.0, 64.0),
    task(20),
)
_CORNERS = ((-6, -12), (66, -6), (66, 50), (50, 86), (-8, 80))
FENCE = (*(item(5001, north, east, 5.0) for north, east in _CORNERS), item(5004, 30, 38, 5.0))
RALLY = (item(5100, -3.0, 66.0),)
PLANS: dict[PlanKind, tuple[PlanItem, ...]] = {
    PlanKind.MISSION: MISSION,
    PlanKind.FENCE: FENCE,
    PlanKind.RALLY: RALLY,
}
_DRIVEN = ((0, 0), (12, 5), (52, 12), (52, 30), (9, 28), (9, 48), (30, 49))
MODES = tuple(PlanMode(name, name not in ("MANUAL", "HOLD", "STEERING", "ACRO"))
              for name in ("MANUAL", "ACRO", "STEERING", "HOLD", "AUTO", "RTL", "GUIDED", "LOITER"))  # fmt: skip
SHOWN = vehicle(mode="AUTO", drivable=False, heading=0.05, speed=0.6, demand=None)


def picture(**changes: Any) -> Snapshot:
    """The rover drives its mission."""
    return snapshot(vehicle=msgspec.structs.replace(SHOWN, **changes))


def plan_view(**changes: Any) -> PlanView:
    """Six items are done, the seventh is driven to."""
    view = PlanView(
        system=1, name="Rover 1", autopilot=0, plans=(summary(MISSION), summary(FENCE), summary(RALLY)), current=6,
        reached=(0, 1, 2, 3, 4, 5), state=3, off_line=-0.14, place=at(30, 49), home=HOME,
        home_altitude=584.0, speed=0.8, charge=0.76, charge_rate=0.0006, modes=MODES,
        neighbours=(Neighbour(2, at(20, -4)),),
    )  # fmt: skip
    return msgspec.structs.replace(view, **changes)


def summary(items: Sequence[PlanItem]) -> PlanSummary:
    return PlanSummary(1, len(items))


def pages() -> tuple[PlanPage, ...]:
    """All three plans."""
    return tuple(PlanPage(1, kind, 1, len(items), 0, items) for kind, items in PLANS.items())


def track() -> PlanTrackView:
    """What was driven, with a little sway."""
    points = []
    for (n1, e1), (n2, e2) in pairwise(_DRIVEN):
        for step in range(20):
            part = step / 20
            points.append((n1 + (n2 - n1) * part, e1 + (e2 - e1) * part + 0.3 * math.sin(step)))
    return PlanTrackView(1, HOME, tuple(points))


NONE = (PlanSummary(), PlanSummary(), PlanSummary())
EMPTY = plan_view(plans=(PlanSummary(1), PlanSummary(1), PlanSummary(1)), current=None, reached=(), state=1,
                  off_line=None, place=HOME)  # fmt: skip
LOADING = msgspec.structs.replace(
    EMPTY, plans=NONE, running=(RequestLine(1, "running", "download mission", done=12, total=50, service="plan"),)
)
LACKING = msgspec.structs.replace(
    EMPTY, plans=NONE,
    ended=(RequestLine(1, "no answer", "download mission", "after 16 tries", service="plan"),),
)  # fmt: skip
REFUSED = plan_view(
    ended=(RequestLine(1, "refused", "upload mission of 10 items", "item 8: INVALID_PARAM5_X", service="plan"),)
)
NOWHERE = plan_view(place=None, home=None, current=None, reached=(), off_line=None, neighbours=(),
                    plans=NONE)  # fmt: skip

VIEWS: dict[str, tuple[View, ...]] = {
    "map_empty": (EMPTY, *(PlanPage(1, kind, 1, 0, 0, ()) for kind in PlanKind)),
    "map_loading": (LOADING,),
    "map_lacking": (LACKING,),
    "map_refused": (REFUSED, *pages(), track()),
    "map_nowhere": (NOWHERE,),
    "map": (plan_view(), *pages(), track()),
}
"""Beginning of the name of a frame -> views; the first that fits."""


def views_for(name: str) -> tuple[View, ...]:
    """Return what the station sends for a frame."""
    return next(views for start, views in VIEWS.items() if name.removeprefix("ascii_").startswith(start))


EDITS = ("tab", "end", "up", "up", "tab", "tab", "right", "right", "up", "m", "down", "a", "up", "up")
"""Keys that move an item and add one."""
