"""The small map of the Links screen: all vehicles around the chosen one, in metres."""

from __future__ import annotations

import math

from groundstation.geo import Point
from groundstation.ui.map.draw.plan_map_value import MapMark, PlanMapValue
from groundstation.views.links import VehicleRow, VehiclesView


def build_where(
    view: VehiclesView | None,
    selected: int | None,
    heading: float | None,
    *,
    ascii: bool = False,  # noqa: A002
) -> PlanMapValue:
    """Return the map; `heading` is that of the chosen vehicle, rad."""
    rows = view.rows if view is not None else ()
    chosen = next((row for row in rows if row.system == selected), None)
    if chosen is None or not chosen.has_position:
        return PlanMapValue("no position of the chosen vehicle")
    others = ((row, _point(row)) for row in rows if row is not chosen)
    marks = tuple(MapMark(point, str(row.system), "other") for row, point in others if point is not None)
    from_home = _point(chosen)
    home = None if from_home is None else (-from_home[0], -from_home[1])
    heading = None if heading is None else round(heading, 1)
    return PlanMapValue("", home=home, vehicle=(0.0, 0.0), heading=heading, marks=marks, ascii=ascii)


def _point(row: VehicleRow) -> Point | None:
    """Return where a vehicle is, seen from the chosen one, and the chosen one from its home."""
    if row.distance is None or row.bearing is None:
        return None
    direction = math.radians(row.bearing)
    return row.distance * math.cos(direction), row.distance * math.sin(direction)
