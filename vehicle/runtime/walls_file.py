"""Walls of the simulation from a GeoJSON file: lines, and the outlines of areas."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator
from typing import Any

from vehicle.config.run_settings import SettingsError
from vehicle.navigation.geo import Origin, Point
from vehicle.sim.walls import Segment

WALLS_MAX = 500
"""Pieces of walls: each costs time in each scan."""
FARTHEST = 10e3
"""m from the start of the rover; beyond it longitude and latitude are probably exchanged."""
_DEPTH = {"LineString": 1, "MultiLineString": 2, "Polygon": 2, "MultiPolygon": 3}
"""Geometry -> how deep its positions are nested."""


def read_walls(path: str, origin: Origin) -> list[Segment]:
    """Return the walls of a file. Raises SettingsError with one line."""
    try:
        with open(path, encoding="utf-8") as file:
            root = json.load(file)
        walls = [piece for where, shape in _geometries(root, "the file") for piece in _pieces(shape, where, origin)]
    except OSError as error:
        raise SettingsError(f"walls {path}: {error.strerror}") from error
    except RecursionError as error:
        raise SettingsError(f"walls {path}: nested too deeply") from error
    except ValueError as error:  # also that of JSON and of UTF-8
        raise SettingsError(f"walls {path}: {error}") from error
    if not walls:
        raise SettingsError(f"walls {path}: no wall in it; draw a LineString or a Polygon")
    if len(walls) > WALLS_MAX:
        raise SettingsError(f"walls {path}: {len(walls)} pieces of walls, {WALLS_MAX} at most")
    return walls


def _geometries(value: Any, where: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Return each geometry and where it stands."""
    kind = value.get("type") if isinstance(value, dict) else None
    lists = {"FeatureCollection": "features", "GeometryCollection": "geometries"}
    if kind in lists:
        name = lists[kind]
        if not isinstance(value.get(name), list):
            raise ValueError(f"{where}: {kind} without a list of {name}")
        for index, each in enumerate(value[name], 1):
            yield from _geometries(each, f"{name[:-1] if name == 'features' else 'geometry'} {index}")
    elif kind == "Feature":
        yield from _geometries(value.get("geometry"), where)
    elif kind in _DEPTH:
        yield where, value
    else:
        raise ValueError(f"{where}: {kind or 'no GeoJSON'} is no wall; use LineString or Polygon")


def _pieces(shape: dict[str, Any], where: str, origin: Origin) -> Iterator[Segment]:
    for line in _lines(shape.get("coordinates"), _DEPTH[shape["type"]], where):
        points = [_point(position, f"{where}: position {index}", origin) for index, position in enumerate(line, 1)]
        if len(points) < 2:
            raise ValueError(f"{where}: a wall needs two positions")
        yield from itertools.pairwise(points)


def _lines(value: Any, depth: int, where: str) -> Iterator[list[Any]]:
    if not isinstance(value, list):
        raise ValueError(f"{where}: coordinates are not a list")
    if depth == 1:
        yield value
    else:
        for each in value:
            yield from _lines(each, depth - 1, where)


def _point(position: Any, where: str, origin: Origin) -> Point:
    numbers = position[:2] if isinstance(position, list) else []
    if len(numbers) != 2 or not all(type(each) in (int, float) and math.isfinite(each) for each in numbers):
        raise ValueError(f"{where}: not [longitude, latitude]")
    longitude, latitude = numbers
    if not (abs(latitude) <= 90 and abs(longitude) <= 180):
        raise ValueError(f"{where}: {latitude:g} is not a latitude; GeoJSON has the longitude first")
    point = origin.to_local(latitude, longitude)
    distance = math.hypot(point.north, point.east)
    if distance > FARTHEST:
        raise ValueError(f"{where}: {distance / 1000:.0f} km from the rover; set --home, or exchange its numbers")
    return point
