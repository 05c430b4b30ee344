"""Missions as text: what Mission Planner writes is read and written back alike; MAVProxy reads it."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink import mavwp

from dialects.enums import Autopilot, MissionType
from groundstation.formats.errors import FileFormatError
from groundstation.formats.plan import Plan, PlannedHome, for_vehicle
from groundstation.formats.waypoint_file import format_waypoints, lost_values, parse_waypoints
from link.services.mission.files import encode_plan
from link.services.mission.items import UNSET_COORDINATE as UNSET
from tests.link.mission_rig import plain, waypoint

MISSION_PLANNER = """\
QGC WPL 110
0\t1\t0\t16\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t-35.36326210\t149.16523740\t584.090000\t1
1\t0\t3\t16\t0.00000000\t1.50000000\t0.00000000\t0.00000000\t-35.36275440\t149.16514870\t100.000000\t1
2\t0\t3\t177\t1.00000000\t5.00000000\t0.00000000\t0.00000000\t0.00000000\t0.00000000\t0.000000\t1
"""


PARAMS = (0.0, 1.0, 0.0, 0.5)


def test_mission_planners_file_is_written_back_byte_for_byte() -> None:
    plan = parse_waypoints(MISSION_PLANNER, "x")
    assert plan.home == PlannedHome(-35.3632621, 149.1652374, 584.09)
    assert [item.params[0] for item in plan.mission] == [0.0, 0.0], "the jump leads to the first item"
    assert format_waypoints(plan) == MISSION_PLANNER
    assert parse_waypoints(MISSION_PLANNER.replace("\n", "\r\n"), "x") == plan


def test_the_rovers_own_file_has_no_home() -> None:
    items = (waypoint(0, params=PARAMS), waypoint(1, params=PARAMS))
    plan = parse_waypoints(encode_plan(items).decode(), "x")
    assert plan.home is None
    assert plain(plan.mission) == plain(items)
    assert plain(parse_waypoints(format_waypoints(plan), "x").mission) == plain(items)


def test_a_first_item_that_looks_like_home_is_not_taken_for_it() -> None:
    items = (waypoint(0, frame=0, params=PARAMS), waypoint(1, frame=0, params=PARAMS))
    assert plain(parse_waypoints(format_waypoints(Plan(mission=items)), "x").mission) == plain(items)


@pytest.mark.parametrize(
    ("frame", "place", "fault"),
    [
        (3, "-131.9052\t215.8052", "latitude -131.9052 is not in -90 to 90"),
        (0, "149.1652374\t-35.3632621", "latitude 149.165237 is not in -90 to 90: latitude comes first"),
        (6, "47\t180.1", "longitude 180.1 is not in -180 to 180"),
    ],
)
def test_a_place_that_is_not_on_earth_is_refused(frame: int, place: str, fault: str) -> None:
    with pytest.raises(FileFormatError, match=f"x:2: {fault}"):
        parse_waypoints(f"QGC WPL 110\n1\t0\t{frame}\t16\t0\t0\t0\t0\t{place}\t0\t1\n", "x")


@pytest.mark.parametrize(
    "rest",
    [
        "3\t16\t0\t0\t0\t0\t0\t0\t0\t1",  # a waypoint where the vehicle is
        "3\t183\t1\t1500\t0\t0\t100\t0\t0\t1",  # a command whose parameters 5 and 6 are not a place
        "2\t16\t0\t0\t0\t0\t100\t0\t0\t1",  # no frame with degrees
    ],
)
def test_what_is_no_place_is_not_judged_as_one(rest: str) -> None:
    plan = parse_waypoints(f"QGC WPL 110\n1\t0\t{rest}\n", "x")
    assert len(plan.mission) == 1
    assert plain(parse_waypoints(format_waypoints(plan), "x").mission) == plain(plan.mission)


def test_a_coordinate_that_fits_no_integer_is_refused() -> None:
    with pytest.raises(FileFormatError, match=r"x:2: longitude 215\.8052 is not in -180 to 180"):
        parse_waypoints("QGC WPL 110\n1\t0\t3\t16\t0\t0\t0\t0\t47\t215.8052\t0\t1\n", "x")


def test_pymavlink_reads_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MAVLINK20", raising=False)  # set by other tests, after mavutil has chosen its dialect
    file = tmp_path / "plan.waypoints"
    file.write_text(format_waypoints(Plan(mission=(waypoint(0), waypoint(1)), home=PlannedHome(47.0, 8.0, 400.0))))
    loader: Any = mavwp.MAVWPLoader()  # type: ignore[no-untyped-call]
    assert loader.load(str(file)) == 3
    assert (loader.wp(0).x, loader.wp(0).z) == (47.0, 400.0)
    assert loader.wp(2).x == pytest.approx(waypoint(1).latitude, abs=1e-7)


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("", "f.waypoints:1: is not 'QGC WPL 110'"),
        ("QGC WPL 110\n0\t1\t0\n", "f.waypoints:2: has 3 fields, not 12"),
        ("QGC WPL 110\n\n0 1 0 16 x 0 0 0 0 0 0 1\n", "f.waypoints:3: could not convert string to float: 'x'"),
        ("QGC WPL 110\n0 1 0 16 1e99 0 0 0 0 0 0 1\n", "f.waypoints:2: 1e99 is too large"),
    ],
)
def test_an_error_is_one_line_with_the_place(text: str, error: str) -> None:
    with pytest.raises(FileFormatError) as caught:
        parse_waypoints(text, "f.waypoints")
    assert str(caught.value) == error


@given(st.text())
def test_no_text_raises_anything_else(text: str) -> None:
    for junk in (text, "QGC WPL 110\n" + text):
        with contextlib.suppress(FileFormatError):
            parse_waypoints(junk, "x")


FENCE = """\
QGC WPL 110
0\t0\t0\t5001\t3\t0\t0\t0\t-31.9051\t115.8051\t0\t0
1\t0\t0\t5001\t3\t0\t0\t0\t-31.9051\t115.8061\t0\t0
2\t0\t0\t5001\t3\t0\t0\t0\t-31.9061\t115.8061\t0\t0
"""
"""As `fence save` of MAVProxy writes it."""


def test_items_go_into_the_plan_that_their_command_is_of() -> None:
    fence = parse_waypoints(FENCE, "x")
    assert (fence.mission, len(fence.fence), fence.rally, fence.home) == ((), 3, (), None)
    assert fence.fence[0].latitude == pytest.approx(-31.9051)
    rally = parse_waypoints("QGC WPL 110\n0\t0\t0\t5100\t0\t0\t0\t0\t-31.9055\t115.8055\t0\t0\n", "x")
    assert (rally.mission, rally.fence, len(rally.rally)) == ((), (), 1)
    assert parse_waypoints(format_waypoints(fence), "x").fence == parse_waypoints(FENCE, "x").fence
    assert format_waypoints(fence).splitlines()[1].split("\t")[:4] == ["0", "1", "0", "5001"], "no home in front"


def test_jumps_of_a_mixed_file_lead_to_the_same_items() -> None:
    lines = [
        "0\t1\t0\t16\t0\t0\t0\t0\t-35\t149\t0\t1",
        "1\t0\t3\t5100\t0\t0\t0\t0\t-35\t149\t0\t1",
        "2\t0\t3\t16\t7\t0\t0\t0\t-35\t149\t0\t1",
        "3\t0\t3\t177\t2\t5\t0\t0\t0\t0\t0\t1",
    ]
    plan = parse_waypoints("\n".join(["QGC WPL 110", *lines]), "x")
    assert [item.params[0] for item in plan.mission] == [7.0, 0.0]
    assert len(plan.rally) == 1
    with pytest.raises(FileFormatError, match=r"fit into a \.plan only"):
        format_waypoints(plan)


def test_parameters_5_and_6_that_are_no_place_are_plain() -> None:
    for frame in (0, 2, 3):
        [item] = parse_waypoints(f"QGC WPL 110\n1\t0\t{frame}\t203\t0\t0\t0\t0\t1\t2\t0\t1\n", "x").mission
        assert (item.x, item.y) == (1, 2)
        [sent] = for_vehicle(Plan(mission=(item,)), MissionType.MISSION, Autopilot.PX4)
        assert (sent.frame, sent.x, sent.y) == (2, 1, 2), "MAV_FRAME_MISSION: PX4 takes no other"


def test_what_is_not_set_is_0_and_named() -> None:
    nan = float("nan")
    plan = Plan(
        mission=(waypoint(0, params=(0.0, 0.0, 0.0, nan)), waypoint(1, x=UNSET, y=UNSET), waypoint(2, params=PARAMS))
    )
    text = format_waypoints(plan)
    assert "nan" not in text
    assert "214.7" not in text
    assert lost_values(plan) == "2 items have values that are not set (NaN), 0 in this file: a .plan keeps them"
    assert lost_values(parse_waypoints(text, "x")) == ""
