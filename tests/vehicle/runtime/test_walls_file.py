"""Walls from GeoJSON files, and one line for each that is wrong."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from vehicle.config.run_settings import SettingsError
from vehicle.navigation.geo import Origin
from vehicle.runtime.walls_file import WALLS_MAX, read_walls

HOME = Origin(50.0, 8.0)
LINE = {"type": "LineString", "coordinates": [[8.0, 50.0001], [8.0001, 50.0001], [8.0001, 50.0, 12.5]]}
AREA = {"type": "Polygon", "coordinates": [[[8.0, 50.0], [8.0001, 50.0], [8.0, 50.0001], [8.0, 50.0]]]}


def written(folder: Path, content: Any) -> str:
    path = folder / "walls.geojson"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return str(path)


def test_lines_and_areas_are_walls(tmp_path: Path) -> None:
    features = [{"type": "Feature", "properties": None, "geometry": each} for each in (LINE, AREA)]
    walls = read_walls(written(tmp_path, {"type": "FeatureCollection", "features": features}), HOME)
    assert len(walls) == 5
    start, end = walls[0]
    assert (start.north, start.east) == pytest.approx((11.1, 0.0), abs=0.1)
    assert (end.north, end.east) == pytest.approx((11.1, 7.2), abs=0.1)


@pytest.mark.parametrize(
    ("content", "parts"),
    [
        ("{", ["Expecting"]),
        ("[" * 5000, ["nested too deeply"]),
        ([], ["the file: no GeoJSON"]),
        ({"type": "FeatureCollection"}, ["without a list of features"]),
        ({"type": "FeatureCollection", "features": []}, ["no wall in it", "LineString"]),
        ({"type": "FeatureCollection", "features": [{"type": "Feature", "geometry": {"type": "Point"}}]},
         ["feature 1: Point is no wall"]),
        ({"type": "LineString", "coordinates": [[8.0, 50.0]]}, ["two positions"]),
        ({"type": "LineString", "coordinates": 5}, ["not a list"]),
        ({"type": "LineString", "coordinates": [[8.0, 50.0], [8.0, "x"]]}, ["position 2", "[longitude, latitude]"]),
        ({"type": "LineString", "coordinates": [[8.0, 50.0], [50.0, 95.0]]}, ["longitude first"]),
        ({"type": "LineString", "coordinates": [[50.0, 8.0], [50.0, 8.1]]}, ["km from the rover", "--home"]),
        ({"type": "LineString", "coordinates": [[8.0, 50.0]] * (WALLS_MAX + 2)}, [f"{WALLS_MAX} at most"]),
    ],
)  # fmt: skip
def test_a_wrong_file_is_one_line(content: Any, parts: list[str], tmp_path: Path) -> None:
    with pytest.raises(SettingsError) as error:
        read_walls(written(tmp_path, content), HOME)
    assert "\n" not in str(error.value)
    for part in parts:
        assert part in str(error.value)


def test_a_file_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=r"none\.geojson: No such file"):
        read_walls(str(tmp_path / "none.geojson"), HOME)
