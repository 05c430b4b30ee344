"""GeoJSON as layers of the map: each kind of shape, damaged files, and thinning."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from groundstation.formats.errors import FileFormatError
from groundstation.formats.geojson import format_geojson
from groundstation.formats.geojson_layer import parse_layer, thin
from groundstation.formats.layer import LayerShape
from groundstation.formats.plan import Plan, PlannedHome
from groundstation.geo import Place

SQUARE = [[8.0, 47.0], [8.1, 47.0], [8.1, 47.1], [8.0, 47.0]]


def feature(kind: str, coordinates: Any, **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": properties}


def parse(*features: Any) -> tuple[LayerShape, ...]:
    return parse_layer(json.dumps({"type": "FeatureCollection", "features": list(features)}), "a.geojson")


def test_each_kind_of_shape() -> None:
    shapes = parse(
        feature("Point", [8.0, 47.0, 500.0], name="gate\x1b[2J"),
        feature("MultiPoint", [[8.0, 47.0], [8.1, 47.1]]),
        feature("LineString", SQUARE[:2], title="path"),
        feature("MultiLineString", [SQUARE[:2], SQUARE[1:3]]),
        feature("Polygon", [SQUARE, SQUARE]),
        feature("MultiPolygon", [[SQUARE], [SQUARE]]),
        {"type": "Feature", "geometry": None, "properties": None},
        {"type": "GeometryCollection", "geometries": [{"type": "Point", "coordinates": [1, 2]}]},
    )
    assert [(len(each.places), each.closed) for each in shapes] == [
        (1, False), (1, False), (1, False), (2, False), (2, False), (2, False), *[(4, True)] * 4, (1, False),
    ]  # fmt: skip
    assert shapes[0] == LayerShape((Place(47.0, 8.0),), name="gate[2J")
    assert shapes[3].name == "path"
    assert shapes[-1].places == (Place(2.0, 1.0),)


def test_a_single_geometry_and_our_own_files_are_read() -> None:
    assert len(parse_layer(json.dumps({"type": "Point", "coordinates": [1, 2]}), "a")) == 1
    assert len(parse_layer(format_geojson(Plan(home=PlannedHome(47.0, 8.0, 5.0))), "a")) == 1


@pytest.mark.parametrize(
    ("feature", "fault"),
    [
        (feature("Point", [8.0, math.nan]), "feature 2: position 1: latitude nan is not in -90 to 90"),
        (feature("LineString", [[8, 47], [math.inf, 4]]), "feature 2: position 2: longitude inf is not in -180 to 180"),
        (feature("Point", [47.0, 149.2]), "latitude 149.2 is not in -90 to 90; GeoJSON has the longitude first"),
        (feature("Point", [8.0, 10**400]), "feature 2: position 1: is not a list of longitude and latitude"),
        (feature("Point", [8.0]), "feature 2: position 1: is not a list of longitude and latitude"),
        (feature("Point", ["8", "47"]), "feature 2: position 1: is not a list of longitude and latitude"),
        (feature("Point", None), "feature 2: position 1: is not a list of longitude and latitude"),
        (feature("LineString", [[8, 47]]), "feature 2: LineString has 1 positions, fewer than 2"),
        (feature("Polygon", [SQUARE[:2]]), "feature 2: Polygon has 2 positions, fewer than 3"),
        (feature("Polygon", 5), 'feature 2: "coordinates" is not a list of shapes'),
        (feature("LineString", {}), 'feature 2: "coordinates" is not a list of positions'),
        (feature("Circle", []), "feature 2: \"type\" is 'Circle', which is none of GeoJSON"),
        (7, "feature 2: is not an object"),
        ({"type": "FeatureCollection", "features": 1}, 'feature 2: "features" is not a list'),
    ],
)
def test_a_damaged_feature_is_named(feature: Any, fault: str) -> None:
    first = {"type": "Point", "coordinates": [1, 2]}
    with pytest.raises(FileFormatError) as error:
        parse(first, feature)
    assert str(error.value).startswith("a.geojson: feature 2: ")
    assert fault in str(error.value)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ('{"type": "Feature",\n "geometry"', "a.geojson:2: this is not JSON"),
        ("[" * 100_000, "nested too deeply"),
        ("[]", "it is not a JSON object"),
        ('{"type": "FeatureCollection", "features": []}', "there is no shape in it"),
    ],
)
def test_a_damaged_file_is_one_line(text: str, fault: str) -> None:
    with pytest.raises(FileFormatError) as error:
        parse_layer(text, "a.geojson")
    assert fault in str(error.value)
    assert "\n" not in str(error.value)


def test_collections_do_not_nest_without_end() -> None:
    inner: dict[str, Any] = {"type": "Point", "coordinates": [1, 2]}
    for _ in range(10):
        inner = {"type": "GeometryCollection", "geometries": [inner]}
    with pytest.raises(FileFormatError, match="nested too deeply"):
        parse_layer(json.dumps(inner), "a")


def test_10000_positions_are_thinned_and_keep_their_outline() -> None:
    circle = tuple(
        Place(47 + 0.01 * math.cos(step / 5000 * math.pi), 8 + 0.01 * math.sin(step / 5000 * math.pi))
        for step in range(10_000)
    )  # fmt: skip
    points = tuple(LayerShape((place,)) for place in circle)
    for shapes in ((LayerShape(circle),), points):
        found = thin(shapes, 2000)
        count = sum(len(each.places) for each in found)
        assert 500 < count <= 2000
        latitudes = [place.latitude for each in found for place in each.places]
        assert (min(latitudes), max(latitudes)) == pytest.approx((46.99, 47.01), abs=0.0001)
    assert thin(points[:2000], 2000) == points[:2000]


def test_many_small_shapes_are_thinned_to_those_that_can_be_seen() -> None:
    tiny = tuple(LayerShape((Place(47.0, at * 1e-4), Place(47.00001, at * 1e-4))) for at in range(10_000))
    large = LayerShape((Place(47.0, 0.0), Place(48.0, 0.0), Place(48.0, 1.0)), closed=True)
    assert thin((*tiny, large), 2000) == (large,)
