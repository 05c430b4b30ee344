"""Plans as GeoJSON (RFC 7946), to write only: maps show it, no ground station reads it back."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from typing import Any

from dialects.enums import Command, FenceItem, command_name
from groundstation.formats.plan import Plan
from groundstation.geo import LocalFrame, Place
from link.services.mission.items import GLOBAL_FRAMES, UNSET_COORDINATE, Items, MissionItem
from link.services.param.float32 import shortest_float32

ARC = 64
"""Corners of a circle, which GeoJSON lacks."""
_POLYGONS = (FenceItem.POLYGON_INCLUSION, FenceItem.POLYGON_EXCLUSION)
_CIRCLES = (FenceItem.CIRCLE_INCLUSION, FenceItem.CIRCLE_EXCLUSION)
_INCLUSIONS = (FenceItem.POLYGON_INCLUSION, FenceItem.CIRCLE_INCLUSION)


def format_geojson(plan: Plan) -> str:
    """Return the text of a file: the mission as points and a line, the fence as polygons, rally points, home."""
    features = [*_mission(plan), *_fence(plan.fence), *_points(plan.rally, "rally")]
    if plan.home is not None:
        features.append(_feature("Point", [plan.home.longitude, plan.home.latitude], {"plan": "home"}))
    return json.dumps({"type": "FeatureCollection", "features": features}, indent=2) + "\n"


def _mission(plan: Plan) -> Iterator[dict[str, Any]]:
    driven = [item for item in plan.mission if item.command <= Command.NAV_DELAY and _has_place(item)]
    if len(driven) > 1:
        yield _feature("LineString", [_position(item) for item in driven], {"plan": "mission"})
    yield from _points(plan.mission, "mission")


def _points(items: Items, plan: str) -> Iterator[dict[str, Any]]:
    for number, item in enumerate(items):
        if _has_place(item):
            params = {
                f"param{at}": shortest_float32(value) for at, value in enumerate(item.params, 1) if value == value
            }
            fields = {"plan": plan, "index": number, "command": command_name(item.command), **params}
            yield _feature("Point", [*_position(item), shortest_float32(item.z)], fields)


def _fence(items: Items) -> Iterator[dict[str, Any]]:
    at = 0
    while at < len(items):
        item, count = items[at], 1
        inclusion = item.command in _INCLUSIONS
        if item.command in _POLYGONS:
            count = max(1, int(item.params[0])) if math.isfinite(item.params[0]) else 1
            yield _polygon([_position(each) for each in items[at : at + count]], inclusion)
        elif item.command in _CIRCLES and math.isfinite(item.params[0]):
            yield _polygon(_circle(item), inclusion)
        at += count


def _circle(item: MissionItem) -> list[list[float]]:
    radius, frame = item.params[0], LocalFrame(Place(item.latitude, item.longitude))
    angles = [math.tau * step / ARC for step in range(ARC)]
    corners = (frame.to_place((radius * math.sin(each), radius * math.cos(each))) for each in angles)
    return [[corner.longitude, corner.latitude] for corner in corners]


def _polygon(corners: list[list[float]], inclusion: bool) -> dict[str, Any]:
    return _feature("Polygon", [[*corners, corners[0]]], {"plan": "fence", "inclusion": inclusion})


def _feature(kind: str, coordinates: Sequence[Any], fields: dict[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": fields}


def _has_place(item: MissionItem) -> bool:
    return item.frame in GLOBAL_FRAMES and (item.x, item.y) != (0, 0) and UNSET_COORDINATE not in (item.x, item.y)


def _position(item: MissionItem) -> list[float]:
    return [item.longitude, item.latitude]
