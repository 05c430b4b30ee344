"""Reads GeoJSON (RFC 7946) as shapes to look at: points, lines and areas. Errors name the file and the feature."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from groundstation.formats.errors import FileFormatError, shown
from groundstation.formats.json_reader import load_object
from groundstation.formats.layer import LayerShape
from groundstation.geo import MAX_LATITUDE, MAX_LONGITUDE, Place

MAX_FEATURES = 50_000
MAX_PLACES = 500_000
MAX_DEPTH = 4
"""Of collections in collections."""
MAX_NAME = 24
_NAMES = ("name", "Name", "title")
"""Properties that name a feature."""
_GEOMETRIES = {
    "Point": (0, 1),
    "MultiPoint": (1, 1),
    "LineString": (0, 2),
    "MultiLineString": (1, 2),
    "Polygon": (1, 3),
    "MultiPolygon": (2, 3),
}
"""Type -> how deep lists of shapes are nested, and the fewest places of a shape: one is a point, three are an area."""


def parse_layer(text: str, source: str) -> tuple[LayerShape, ...]:
    """Return the shapes of a file. Raises FileFormatError, with `source` and the place in it."""
    root = load_object(text, source, "GeoJSON", constants=True)
    shapes = tuple(_object(root, source, "", 0))
    if not shapes:
        raise FileFormatError(f"{source}: there is no shape in it")
    if (total := sum(len(shape.places) for shape in shapes)) > MAX_PLACES:
        raise FileFormatError(f"{source}: {total} positions, more than {MAX_PLACES}")
    return shapes


def _object(value: Any, where: str, name: str, depth: int) -> Iterator[LayerShape]:
    """Yield the shapes of a feature, of a geometry or of a collection of them."""
    if not isinstance(value, dict):
        raise FileFormatError(f"{where}: is not an object")
    if depth > MAX_DEPTH:
        raise FileFormatError(f"{where}: collections are nested too deeply")
    kind = value.get("type")
    if kind == "FeatureCollection":
        yield from _members(value, "features", "feature", where, name, depth)
    elif kind == "GeometryCollection":
        yield from _members(value, "geometries", "geometry", where, name, depth)
    elif kind == "Feature":
        if value.get("geometry") is not None:  # a feature without a place
            yield from _object(value["geometry"], where, _name(value), depth + 1)
    elif isinstance(kind, str) and kind in _GEOMETRIES:
        yield from _geometry(value.get("coordinates"), kind, where, name)
    else:
        raise FileFormatError(f'{where}: "type" is {shown(str(kind))}, which is none of GeoJSON')


def _members(value: dict[str, Any], key: str, word: str, where: str, name: str, depth: int) -> Iterator[LayerShape]:
    found = value.get(key)
    if not isinstance(found, list):
        raise FileFormatError(f'{where}: "{key}" is not a list')
    if len(found) > MAX_FEATURES:
        raise FileFormatError(f'{where}: "{key}" has {len(found)} entries, more than {MAX_FEATURES}')
    for number, each in enumerate(found, 1):
        yield from _object(each, f"{where}: {word} {number}", name, depth + 1)


def _name(feature: dict[str, Any]) -> str:
    fields = feature.get("properties")
    found = next((fields[key] for key in _NAMES if fields.get(key)), "") if isinstance(fields, dict) else ""
    return "".join(each for each in str(found) if each.isprintable())[:MAX_NAME]


def _geometry(coordinates: object, kind: str, where: str, name: str) -> Iterator[LayerShape]:
    depth, least = _GEOMETRIES[kind]
    for shape in _nested(coordinates, depth, where):
        places = _places([shape] if least == 1 else shape, where)
        if least > 1 and len(places) < least:
            raise FileFormatError(f"{where}: {kind} has {len(places)} positions, fewer than {least}")
        yield LayerShape(places, least == 3, name)


def _nested(value: object, depth: int, where: str) -> Iterator[object]:
    """Yield what lies this deep in lists of lists."""
    if depth == 0:
        yield value
        return
    if not isinstance(value, list):
        raise FileFormatError(f'{where}: "coordinates" is not a list of shapes')
    for each in value:
        yield from _nested(each, depth - 1, where)


def _places(value: object, where: str) -> tuple[Place, ...]:
    if not isinstance(value, list):
        raise FileFormatError(f'{where}: "coordinates" is not a list of positions')
    return tuple(_place(each, f"{where}: position {number}") for number, each in enumerate(value, 1))


def _place(value: object, where: str) -> Place:
    """Return a position, which has the longitude first."""
    if not isinstance(value, list) or len(value) < 2 or not all(map(_is_number, value[:2])):
        raise FileFormatError(f"{where}: is not a list of longitude and latitude")
    longitude, latitude = (float(each) for each in value[:2])
    if not abs(latitude) <= MAX_LATITUDE:  # NaN is refused, too
        raise FileFormatError(f"{where}: latitude {latitude:g} is not in -90 to 90; GeoJSON has the longitude first")
    if not abs(longitude) <= MAX_LONGITUDE:
        raise FileFormatError(f"{where}: longitude {longitude:g} is not in -180 to 180")
    return Place(latitude, longitude)


def _is_number(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return isinstance(value, float) or abs(value) < 10**9  # a longer whole number is not a float


def thin(shapes: tuple[LayerShape, ...], most: int) -> tuple[LayerShape, ...]:
    """Return shapes with at most so many places: those close to the one before go, and shapes too small to see."""
    spacing, found = 0.0, shapes
    while sum(len(shape.places) for shape in found) > most:
        spacing = spacing * 1.5 if spacing else 1e-6
        found = _spaced(shapes, spacing)
    return found


def _spaced(shapes: tuple[LayerShape, ...], spacing: float) -> tuple[LayerShape, ...]:
    """Return shapes whose places are so many degrees of latitude apart; of points in one square the first."""
    found, taken = [], set()
    for shape in shapes:
        if len(shape.places) == 1:
            square = tuple(round(degrees / spacing) for degrees in shape.places[0])
            if square not in taken:
                found.append(shape)
            taken.add(square)
            continue
        places = _spaced_line(shape.places, spacing)
        if len(places) > (2 if shape.closed else 1):
            found.append(LayerShape(places, shape.closed, shape.name))
    return tuple(found)


def _spaced_line(places: tuple[Place, ...], spacing: float) -> tuple[Place, ...]:
    kept = [places[0]]
    shrink = math.cos(math.radians(places[0].latitude))
    for place in places[1:]:
        north, east = place.latitude - kept[-1].latitude, (place.longitude - kept[-1].longitude) * shrink
        if math.hypot(north, east) >= spacing:
            kept.append(place)
    return tuple(kept)
