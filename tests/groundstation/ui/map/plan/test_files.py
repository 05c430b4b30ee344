"""Plan files through the converter, a real process: what comes back, what is damaged, nothing half written."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from msgspec.msgpack import encode

from groundstation.formats.errors import FileFormatError
from groundstation.geo import Place
from groundstation.ui.map.plan.files import MapFileError, open_plan, save_plan
from groundstation.verbs.common.exit_codes import VerbError
from groundstation.verbs.mission.plan_converter import main, write
from groundstation.views.plan import PlanDocument
from tests.groundstation.ui.map.plans import HOME, item, square, task

MISSION = (item(16, 1, 2, 3.0), task(178, 1.0, 0.5), task(31_999, 7.0), task(177, 0.0, 2.0))
DOCUMENT = PlanDocument((MISSION, (*square(9), item(5004, 3, 3, 2.5)), (item(5100, 5, 5),)), HOME, 584.0)


async def test_a_plan_comes_back_as_it_was_saved(tmp_path: Path) -> None:
    file = tmp_path / "a.plan"
    await save_plan(file, DOCUMENT)
    again = await open_plan(file)
    assert again.plans[0][:2] == DOCUMENT.plans[0][:2]
    assert again.plans[0][2].command == 31_999, "an unknown command is kept"
    assert again.plans[1:] == DOCUMENT.plans[1:]
    assert again.home == Place(round(HOME.latitude, 7), round(HOME.longitude, 7))
    with pytest.raises(MapFileError, match="exists already"):
        await save_plan(file, DOCUMENT)


def run(capsysbinary: pytest.CaptureFixture[bytes], *arguments: str) -> tuple[int, str]:
    code = main(arguments)
    return code, capsysbinary.readouterr().err.decode()


@pytest.mark.parametrize(
    ("name", "text", "fault"),
    [
        ("a.plan", "{", "a.plan:1: this is not JSON"),
        ("a.plan", '{"fileType": "Plan", "mission": {"items": [{"type": "SimpleItem", "command": 16, "frame": 3, '
         '"params": [0, 0, 0, 0, 95, 8, 0]}]}}', "mission: items 1: latitude 95 is not in -90 to 90"),
        ("a.plan", '{"fileType": "Plan", "mission": {"items": [NaN]}}', "NaN is not a number of JSON"),
        ("a.waypoints", "QGC WPL 110\n0\t1\n", "a.waypoints:2: has 2 fields, not 12"),
        ("a.waypoints", "something else", "is not 'QGC WPL 110'"),
        ("a.plan", None, "No such file"),
    ],
)  # fmt: skip
def test_a_damaged_file_is_one_line(
    capsysbinary: pytest.CaptureFixture[bytes], tmp_path: Path, name: str, text: str | None, fault: str
) -> None:
    if text is not None:
        (tmp_path / name).write_text(text)
    code, errors = run(capsysbinary, "read", str(tmp_path / name))
    assert code == 2
    assert fault.split(":")[-1].strip() in errors
    assert errors.count("\n") == 1


def test_a_plan_that_is_too_long_names_what_to_use(capsysbinary: pytest.CaptureFixture[bytes], tmp_path: Path) -> None:
    simple = {"type": "SimpleItem", "command": 16, "frame": 3, "params": [0, 0, 0, 0, 48, 8, 0]}
    (tmp_path / "a.plan").write_text(json.dumps({"fileType": "Plan", "mission": {"items": [simple] * 10_000}}))
    code, errors = run(capsysbinary, "read", str(tmp_path / "a.plan"))
    assert code == 2
    assert "mission of 10000 items, this screen edits 3000 at most: use mavhelm mission put" in errors


def test_geojson_has_the_mission_the_fence_and_the_rally_points(tmp_path: Path) -> None:
    write(str(tmp_path / "a.geojson"), encode(DOCUMENT), replace=False)
    features = json.loads((tmp_path / "a.geojson").read_text())["features"]
    kinds = [(each["properties"]["plan"], each["geometry"]["type"]) for each in features]
    fence = [("fence", "Polygon"), ("fence", "Polygon")]
    assert kinds == [("mission", "Point"), *fence, ("rally", "Point"), ("home", "Point")]
    corners = features[1]["geometry"]["coordinates"][0]
    assert corners[0] == corners[-1]
    assert features[0]["geometry"]["coordinates"][:2] == [MISSION[0].y / 1e7, MISSION[0].x / 1e7]


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("a.waypoints", "a mission, a fence and rally points together fit into a .plan only"),
        ("a.doc", "name it .plan, .waypoints or .geojson"),
        ("no/a.plan", "there is no folder"),
    ],
)
def test_what_a_format_lacks_is_refused_and_nothing_is_written(tmp_path: Path, name: str, fault: str) -> None:
    with pytest.raises((VerbError, FileFormatError), match=re.escape(fault)):
        write(str(tmp_path / name), encode(DOCUMENT), replace=False)
    assert list(tmp_path.iterdir()) == []


def test_a_file_is_replaced_whole(tmp_path: Path) -> None:
    file = tmp_path / "a.plan"
    write(str(file), encode(DOCUMENT), replace=False)
    write(str(file), encode(PlanDocument(((), (), ()), HOME)), replace=True)
    assert json.loads(file.read_text())["mission"]["items"] == []
    assert list(tmp_path.iterdir()) == [file]
