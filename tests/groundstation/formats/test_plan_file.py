"""Plans of QGroundControl: read, written back alike, and errors that name the place."""

from __future__ import annotations

import contextlib
import json
import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dialects.enums import Autopilot, Command, FenceItem, MissionType
from groundstation.formats.errors import FileFormatError
from groundstation.formats.plan import Plan, PlannedHome, for_vehicle, from_vehicle, kind_of
from groundstation.formats.plan_file import format_plan, parse_plan
from link.services.mission.items import MissionItem, from_message, to_message
from tests.link.mission_rig import plain
from tests.link.services_world import through_the_wire

NAN = math.nan


def document() -> dict[str, Any]:
    """As QGroundControl 4.4 writes a plan for a rover with a jump, a fence of three kinds and a rally point."""
    return {
        "fileType": "Plan",
        "geoFence": {
            "breachReturn": [47.3977, 8.5455, 10],
            "circles": [{"circle": {"center": [47.3975, 8.5457], "radius": 12.5}, "inclusion": False, "version": 1}],
            "polygons": [
                {"inclusion": True, "polygon": [[47.3, 8.5], [47.4, 8.5], [47.4, 8.6]], "version": 1},
            ],
            "version": 2,
        },
        "groundStation": "QGroundControl",
        "mission": {
            "cruiseSpeed": 2.5,
            "firmwareType": 3,
            "globalPlanAltitudeMode": 1,
            "hoverSpeed": 5,
            "items": [
                waypoint(1, 47.397742, 8.545594),
                waypoint(2, 47.3979, 8.5458),
                {
                    "autoContinue": True, "command": 177, "doJumpId": 3, "frame": 2,
                    "params": [1, 5, 0, 0, 0, 0, 0], "type": "SimpleItem",
                },
            ],
            "plannedHomePosition": [47.3977419, 8.545594, 487.989],
            "vehicleType": 10,
            "version": 2,
        },
        "rallyPoints": {"points": [[47.3976, 8.5456, 0]], "version": 2},
        "version": 1,
    }  # fmt: skip


def waypoint(number: int, latitude: float, longitude: float) -> dict[str, Any]:
    return {
        "AMSLAltAboveTerrain": None, "Altitude": 0.5, "AltitudeMode": 1, "autoContinue": True, "command": 16,
        "doJumpId": number, "frame": 3, "params": [0, 1.1, 0, None, latitude, longitude, 0.5], "type": "SimpleItem",
    }  # fmt: skip


def as_text(plan: dict[str, Any]) -> str:
    return json.dumps(plan, indent=4, sort_keys=True) + "\n"


def test_a_plan_is_read() -> None:
    plan = parse_plan(as_text(document()), "x")
    assert plain(plan.mission) == plain(
        (
            MissionItem(16, 3, (0.0, 1.1, 0.0, NAN), 473977420, 85455940, 0.5),
            MissionItem(16, 3, (0.0, 1.1, 0.0, NAN), 473979000, 85458000, 0.5),
            MissionItem(177, 2, (0.0, 5.0, 0.0, 0.0), 0, 0, 0.0),
        )
    )
    assert plan.home == PlannedHome(47.3977419, 8.545594, 487.989)
    assert [(item.command, item.params[0]) for item in plan.fence] == [
        *[(FenceItem.POLYGON_INCLUSION, 3.0)] * 3,
        (FenceItem.CIRCLE_EXCLUSION, 12.5),
        (FenceItem.RETURN_POINT, 0.0),
    ]
    assert [(item.command, item.x, item.z) for item in plan.rally] == [(FenceItem.RALLY_POINT, 473976000, 0.0)]


def test_a_plan_is_written_back_byte_for_byte() -> None:
    text = as_text(document() | {"groundStation": "mavhelm"})
    assert format_plan(parse_plan(text, "x")) == text


def test_a_survey_is_its_items() -> None:
    plan = document()
    plan["mission"]["items"] = [
        waypoint(1, 47.0, 8.0),
        {"type": "ComplexItem", "complexItemType": "survey",
         "TransectStyleComplexItem": {"Items": [waypoint(2, 47.1, 8.0), waypoint(3, 47.2, 8.0)]}},
    ]  # fmt: skip
    assert [item.x for item in parse_plan(as_text(plan), "x").mission] == [470000000, 471000000, 472000000]


@pytest.mark.parametrize(("autopilot", "first", "target"), [(Autopilot.ARDUPILOT, 1, 1.0), (Autopilot.GENERIC, 0, 0.0)])
def test_home_is_item_0_on_ardupilot_only(autopilot: int, first: int, target: float) -> None:
    plan = parse_plan(as_text(document()), "x")
    items = for_vehicle(plan, MissionType.MISSION, autopilot)
    assert len(items) == 3 + first
    assert items[first].latitude == pytest.approx(47.397742)
    assert items[-1].params[0] == target, "DO_JUMP leads to the same item"
    if first:
        assert (items[0].frame, items[0].x, items[0].z) == (0, 473977419, 487.989)
    again = from_vehicle(items, MissionType.MISSION, autopilot)
    assert plain(again.mission) == plain(plan.mission)
    assert (again.home is not None) == bool(first)


def test_plans_of_qgroundcontrol_before_3_3_are_read() -> None:
    plan = document()
    plan["mission"]["items"] = [
        {"autoContinue": True, "command": 16, "coordinate": [-31.9052, 115.8053, 0], "doJumpId": 1, "frame": 3,
         "params": [0, 0, 0, None], "type": "SimpleItem"},
        {"autoContinue": True, "command": 178, "coordinate": [0, 0, 0], "id": 2, "frame": 2,
         "param1": 1, "param2": 3, "param3": -1, "param4": 0, "type": "missionItem"},
    ]  # fmt: skip
    plan["geoFence"] = {"polygon": [[-31.90, 115.80], [-31.90, 115.81], [-31.91, 115.81]], "version": 1}
    plan["rallyPoints"] = {"points": [[-31.9, 115.8, 2]], "version": 1}
    read = parse_plan(as_text(plan), "x")
    assert (read.mission[0].x, read.mission[0].y) == (-319052000, 1158053000)
    assert math.isnan(read.mission[0].params[3])
    assert read.mission[1].params == (1, 3, -1, 0)
    assert [(item.command, item.params[0]) for item in read.fence] == [(FenceItem.POLYGON_INCLUSION, 3.0)] * 3
    assert len(read.rally) == 1


@pytest.mark.parametrize(("part", "known"), [(None, 1), ("mission", 2), ("geoFence", 2), ("rallyPoints", 2)])
def test_a_newer_version_is_refused(part: str | None, known: int) -> None:
    plan = document()
    (plan if part is None else plan[part])["version"] = known + 1
    where = "x" if part is None else f"x: {part}"
    with pytest.raises(FileFormatError, match=f'^{where}: "version" is .*{known} is the newest that is known here'):
        parse_plan(as_text(plan), "x")


def test_a_fence_in_a_mission_is_refused() -> None:
    plan = document()
    plan["mission"]["items"][0]["command"] = 5001
    with pytest.raises(FileFormatError, match="items 1: command 5001 belongs to geoFence, not to a mission"):
        parse_plan(as_text(plan), "x")


def broken(*path: Any, value: Any = None, drop: bool = False) -> str:
    plan = document()
    inside: Any = plan
    for step in path[:-1]:
        inside = inside[step]
    if drop:
        del inside[path[-1]]
    else:
        inside[path[-1]] = value
    return as_text(plan)


ITEM = ("mission", "items", 1)


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("", "f.plan:1: this is not JSON: Expecting value"),
        ('{\n"a": 1,\n"b" 2}', "f.plan:3: this is not JSON: Expecting ':' delimiter"),
        ("[]", "f.plan: this is not a plan: it is not a JSON object"),
        ("[" * 100_000, "f.plan: this is not a plan: nested too deeply, or a number too long"),
        ('{"a": ' + "9" * 5000 + "}", "f.plan: this is not a plan: nested too deeply, or a number too long"),
        ('{"fileType": NaN}', "f.plan: NaN is not a number of JSON"),
        ("{}", 'f.plan: "fileType" is missing'),
        (broken("fileType", value="Survey"), "f.plan: \"fileType\" is 'Survey', not \"Plan\""),
        (broken("mission", drop=True), 'f.plan: "mission" is missing'),
        (broken("mission", "items", value=3), 'f.plan: mission: "items" is not a list'),
        (broken("mission", "items", 0, value=[]), "f.plan: mission: items 1 is not an object"),
        (broken(*ITEM, "params", value=[1]), 'f.plan: mission: items 2: "params" has 1 numbers, not 7'),
        (broken(*ITEM, "params", 1, value="x"), "f.plan: mission: items 2: params[1] is not a number"),
        (broken(*ITEM, "params", 1, value=True), "f.plan: mission: items 2: params[1] is not a number"),
        (broken(*ITEM, "params", 1, value=1e300), "f.plan: mission: items 2: params[1] is too large"),
        (broken(*ITEM, "frame", value=10**400), 'f.plan: mission: items 2: "frame" is too large'),
        (
            broken(*ITEM, "params", 4, value=95),
            "f.plan: mission: items 2: latitude 95 is not in -90 to 90: latitude comes first",
        ),
        (broken(*ITEM, "params", 5, value=-181), "f.plan: mission: items 2: longitude -181 is not in -180 to 180"),
        (
            broken(*ITEM, "command", value=-1),
            'f.plan: mission: items 2: "command" is not a whole number from 0 to 65535',
        ),
        (broken(*ITEM, "frame", drop=True), 'f.plan: mission: items 2: "frame" is missing'),
        (
            broken(*ITEM, "type", value="ComplexItem"),
            "f.plan: mission: items 2: 'ComplexItem' has no items that can be uploaded",
        ),
        (broken("geoFence", "polygons", 0, "polygon", 2, drop=True),
         "f.plan: geoFence: polygons 1: a polygon needs at least three corners"),
        (broken("geoFence", "circles", 0, "circle", "radius", value=None),
         'f.plan: geoFence: circles 1: circle: "radius" is not a number'),
        (broken("rallyPoints", "points", 0, value=[1, 2]),
         'f.plan: rallyPoints: points 1: "points" has 2 numbers, not 3'),
    ],
)  # fmt: skip
def test_an_error_is_one_line_with_the_place(text: str, error: str) -> None:
    with pytest.raises(FileFormatError) as caught:
        parse_plan(text, "f.plan")
    assert str(caught.value) == error


FLOATS = st.floats(width=32, allow_infinity=False).map(lambda value: value + 0.0)  # no -0.0: JSON has no need of it
POSITION = st.tuples(st.integers(-900_000_000, 900_000_000), st.integers(-1_800_000_000, 1_800_000_000))


def item(
    command: int, frame: int, params: tuple[float, float, float, float], place: tuple[int, int], z: float
) -> MissionItem:
    return MissionItem(command, frame, params, place[0], place[1], z)


ITEMS = st.builds(
    item,
    st.integers(0, 65535).filter(
        lambda command: command != Command.DO_JUMP and kind_of(command) == MissionType.MISSION
    ),
    st.sampled_from([0, 3, 6, 10]),
    st.tuples(FLOATS, FLOATS, FLOATS, FLOATS),
    POSITION,
    FLOATS.filter(math.isfinite),
)


@given(st.lists(ITEMS, max_size=8))
def test_any_mission_survives_a_file(items: list[MissionItem]) -> None:
    again = parse_plan(format_plan(Plan(mission=tuple(items))), "x").mission
    assert plain(tuple(map(as_float32, again))) == plain(tuple(map(as_float32, items)))


def as_float32(item: MissionItem) -> MissionItem:
    return from_message(through_the_wire(to_message(item, 0, 0, (1, 1))))  # type: ignore[arg-type]


JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(
        ["mission", "items", "params", "type", "geoFence", "polygons", "circles", "rallyPoints", "points"]), inner),
)  # fmt: skip


@given(JSON)
def test_no_json_raises_anything_else(value: Any) -> None:
    with contextlib.suppress(FileFormatError):
        parse_plan(json.dumps({"fileType": "Plan", "mission": value}), "x")
    with contextlib.suppress(FileFormatError):
        parse_plan(json.dumps(document() | (value if isinstance(value, dict) else {})), "x")


@given(st.text())
def test_no_text_raises_anything_else(text: str) -> None:
    with contextlib.suppress(FileFormatError):
        parse_plan(text, "x")
