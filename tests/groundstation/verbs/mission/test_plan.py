"""`mavhelm mission`, `fence` and `rally` with vehicles as ArduPilot and PX4 behave, on real sockets."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from groundstation.verbs.common.exit_codes import ExitCode
from tests.fakes.services import ARDUPILOT, PX4, ForeignVehicle, foreign_vehicle
from tests.groundstation.formats.test_plan_file import as_text, document
from tests.groundstation.formats.test_waypoint_file import FENCE, MISSION_PLANNER
from tests.groundstation.verbs.verb_runs import VerbRun, run_until_answered, run_verb

Capture = pytest.CaptureFixture[str]


@pytest.fixture(params=[ARDUPILOT, PX4], ids=["ardupilot", "px4"])
def vehicle(request: pytest.FixtureRequest) -> Iterator[ForeignVehicle]:
    with foreign_vehicle(request.param) as running:
        yield running


@pytest.fixture
def plan_file(tmp_path: Path) -> str:
    file = tmp_path / "a.plan"
    file.write_text(as_text(document()))
    return str(file)


def verb(capsys: Capture, vehicle: ForeignVehicle, *arguments: str) -> VerbRun:
    return run_verb(capsys, *arguments, "-e", vehicle.endpoint, "-v", "1")


def test_a_plan_goes_up_and_comes_down_the_same(
    capsys: Capture, vehicle: ForeignVehicle, plan_file: str, tmp_path: Path
) -> None:
    for kind in ("mission", "fence", "rally"):
        assert verb(capsys, vehicle, kind, "put", plan_file).code == 0
        assert verb(capsys, vehicle, kind, "get", str(tmp_path / f"{kind}.plan")).code == 0
    sent, ours = document(), json.loads((tmp_path / "mission.plan").read_text())
    assert ours["mission"]["items"] == sent["mission"]["items"]
    assert json.loads((tmp_path / "rally.plan").read_text())["rallyPoints"] == sent["rallyPoints"]
    assert json.loads((tmp_path / "fence.plan").read_text())["geoFence"] == sent["geoFence"]
    first = vehicle.missions.items[0][0]
    if vehicle.autopilot == ARDUPILOT:
        assert (len(vehicle.missions.items[0]), first.frame, first.x) == (4, 0, 473977419)
        assert ours["mission"]["plannedHomePosition"] == [47.3977419, 8.545594, 487.989]
    else:
        assert (len(vehicle.missions.items[0]), first.frame, first.x) == (3, 3, 473977420)


def test_a_mission_of_mission_planner(capsys: Capture, vehicle: ForeignVehicle, tmp_path: Path) -> None:
    file, back = tmp_path / "a.waypoints", tmp_path / "b.waypoints"
    file.write_text(MISSION_PLANNER)
    assert verb(capsys, vehicle, "mission", "put", str(file)).code == 0
    assert verb(capsys, vehicle, "mission", "get", str(back)).code == 0
    if vehicle.autopilot == ARDUPILOT:
        assert back.read_text() == MISSION_PLANNER
    jump = vehicle.missions.items[0][-1]
    assert jump.param1 == (1 if vehicle.autopilot == ARDUPILOT else 0)


def test_a_fence_of_mavproxy(capsys: Capture, vehicle: ForeignVehicle, tmp_path: Path) -> None:
    file, back = tmp_path / "fence.txt", tmp_path / "back.waypoints"
    file.write_text(FENCE)
    assert verb(capsys, vehicle, "fence", "put", str(file)).code == 0
    assert [each.command for each in vehicle.missions.items[1]] == [5001] * 3
    assert 0 not in vehicle.missions.items or not vehicle.missions.items[0]
    assert verb(capsys, vehicle, "fence", "get", str(back)).code == 0
    assert verb(capsys, vehicle, "fence", "check", str(back)).code == 0


def test_values_that_waypoints_cannot_hold_are_named(
    capsys: Capture, vehicle: ForeignVehicle, plan_file: str, tmp_path: Path
) -> None:
    assert verb(capsys, vehicle, "mission", "put", plan_file).code == 0
    saved = verb(capsys, vehicle, "mission", "get", str(tmp_path / "a.waypoints"))
    assert saved.code == 0
    assert "values that are not set (NaN), 0 in this file" in saved.err
    assert "nan" not in (tmp_path / "a.waypoints").read_text()


def test_show_and_clear(capsys: Capture, vehicle: ForeignVehicle, plan_file: str) -> None:
    verb(capsys, vehicle, "fence", "put", plan_file)
    shown = verb(capsys, vehicle, "fence", "show")
    assert shown.out.splitlines()[3] == (
        "    3  NAV_FENCE_CIRCLE_EXCLUSION   47.3975000 8.5457000 0 m               1=12.5"
    )
    records = verb(capsys, vehicle, "fence", "show", "--json").records
    assert (len(records), records[0]["command"], records[0]["param1"]) == (5, 5001, 3.0)
    assert verb(capsys, vehicle, "fence", "clear").code == 0
    assert vehicle.missions.items[1] == []
    empty = verb(capsys, vehicle, "fence", "show")
    assert (empty.code, empty.out) == (0, "")
    assert "has no fence" in empty.err


def test_the_refused_item_is_named_and_the_old_plan_stays(
    capsys: Capture, vehicle: ForeignVehicle, plan_file: str
) -> None:
    assert verb(capsys, vehicle, "mission", "set", plan_file).code == 0  # another word for put
    before = vehicle.missions.items[0]
    vehicle.missions.refuse = {1: 10}
    refused = verb(capsys, vehicle, "mission", "put", plan_file)
    assert refused.code == ExitCode.REFUSED
    assert "refused, item 1: INVALID_PARAM5_X" in refused.err
    assert vehicle.missions.items[0] is before


def test_a_vehicle_without_missions(capsys: Capture, vehicle: ForeignVehicle) -> None:
    vehicle.silent.add(43)  # MISSION_REQUEST_LIST
    shown = verb(capsys, vehicle, "mission", "show")
    assert shown.code == ExitCode.NO_ANSWER
    assert "download mission: no answer, after 16 tries" in shown.err
    assert len(vehicle.of("MISSION_REQUEST_LIST")) == 16


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_a_plan_over_a_link_that_loses(capsys: Capture, autopilot: int, plan_file: str, tmp_path: Path) -> None:
    with foreign_vehicle(autopilot, loss=0.2) as vehicle:
        for words in (("put", plan_file), ("get", str(tmp_path / "b.plan"))):
            run = run_until_answered(capsys, "mission", *words, "-e", vehicle.endpoint, "-v", "1")
            assert run.code == 0, run.err
        ours = json.loads((tmp_path / "b.plan").read_text())
        assert ours["mission"]["items"] == document()["mission"]["items"]


def test_files_that_cannot_be_used(capsys: Capture, vehicle: ForeignVehicle, tmp_path: Path) -> None:
    empty = document()
    empty["rallyPoints"]["points"] = []
    (tmp_path / "empty.plan").write_text(as_text(empty))
    (tmp_path / "fence.txt").write_text(FENCE)
    (tmp_path / "bad.waypoints").write_text("QGC WPL 110\n0 1\n")
    for arguments, code, words in (
        (["rally", "put", str(tmp_path / "empty.plan")], ExitCode.DIFFERS, "no rally points in it"),
        (["mission", "put", str(tmp_path / "bad.waypoints")], ExitCode.USAGE, "bad.waypoints:2: has 2 fields, not 12"),
        (
            ["mission", "put", str(tmp_path / "fence.txt")],
            ExitCode.DIFFERS,
            "no mission in it; but a fence of 3 items (`fence put`)",
        ),
        (["mission", "get", str(tmp_path / "empty.plan")], ExitCode.USAGE, "exists already"),
    ):
        run = verb(capsys, vehicle, *arguments)
        assert run.code == code, run.err
        assert words in run.err
        assert run.err.count("\n") == 1
