"""Pictures of how cost grows: valid SVG with every figure in it, for readers of the text as well."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.benchmarks.pictures import PICTURES, draw, write_pictures

SVG = "{http://www.w3.org/2000/svg}"
POINTS = [(1.0, 3.5), (10.0, 4.2), (100.0, 11.0)]


def test_each_point_is_drawn_at_its_figures_and_told_in_words() -> None:
    root = ElementTree.fromstring(draw(PICTURES[1], POINTS, "a run & its machine"))
    places = [(float(each.attrib["cx"]), float(each.attrib["cy"])) for each in root.iter(f"{SVG}circle")]
    assert [x for x, _ in places] == pytest.approx([70.0, 340.0, 610.0])  # a decade is a decade
    assert [y for _, y in places] == sorted((y for _, y in places), reverse=True)  # dearer is higher
    told = root.findtext(f"{SVG}desc") or ""
    assert all(f"{figure:g} %" in told for _, figure in POINTS[:2])
    assert any(each.text == "a run & its machine" for each in root.iter(f"{SVG}text"))


def test_only_benchmarks_of_the_run_are_drawn(tmp_path: Path) -> None:
    rows = [{"further vehicles": 0, "CPU %": 9.0}, {"further vehicles": 99, "CPU %": 60.0}]
    machine = {"date": "2026-11-23T04:00:00", "cpu": "any", "cores": 2, "load_before": "0.1", "commit": "abc"}
    run = {"quick": True, "machine": machine, "results": {"fleet": {"tables": [{"rows": rows}]}}}
    (file,) = write_pictures(run, tmp_path / "new")
    assert file.name == "cost_fleet.svg"
    assert "1 vehicles: 9 %; 100 vehicles: 60 %" in file.read_text()
