"""Fields of items as text, and commands by what somebody types."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.ui.map.plan.commands import command_title, find_command, short_title
from groundstation.ui.map.plan.fields import ItemField, change_command, change_field, fields_of, number_text, value_of
from groundstation.views.plan import PlanItem, PlanKind
from tests.groundstation.ui.map.plans import item, square, task

MISSION, FENCE, RALLY = PlanKind


def field(of: PlanItem, label: str) -> ItemField:
    return next(each for each in fields_of(of) if each.label == label)


def changed(of: PlanItem, label: str, text: str, first: int = 0) -> PlanItem:
    found = change_field(of, field(of, label), text, first)
    assert isinstance(found, PlanItem), found
    return found


@pytest.mark.parametrize(
    ("of", "labels"),
    [
        (item(16), ["command", "latitude", "longitude", "altitude", "hold", "accept radius", "pass radius", "yaw"]),
        (item(19), ["command", "latitude", "longitude", "altitude", "time", "radius"]),
        (task(20), ["command"]),
        (task(178), ["command", "speed type", "speed", "throttle"]),
        (task(177), ["command", "number", "repeat"]),
        (task(112), ["command", "delay"]),
        (task(181), ["command", "instance", "setting"]),
        (square(5)[0], ["command", "latitude", "longitude", "altitude"]),
        (task(31_999), ["command", *(f"param{number}" for number in range(1, 8))]),
    ],
    ids=lambda value: value.command if isinstance(value, PlanItem) else "",
)
def test_each_command_has_its_own_fields(of: PlanItem, labels: list[str]) -> None:
    assert [each.label for each in fields_of(of)] == labels


def test_values_as_text_and_back() -> None:
    of = item(16, 0, 0, 2.5, math.nan)
    assert value_of(of, field(of, "hold")) == "2.5"
    assert value_of(of, field(of, "accept radius")) == "--"
    assert value_of(of, field(of, "latitude")) == "-35.3632621"
    assert changed(of, "latitude", "-35.5").x == -355_000_000
    assert changed(of, "hold", " 7 ").params[0] == 7.0
    assert math.isnan(changed(of, "hold", "--").params[0])
    assert changed(of, "altitude", "1.5").z == 1.5
    assert changed(task(31_999), "param7", "3").z == 3.0
    assert changed(task(31_999), "param5", "12").x == 12


def test_a_jumps_target_has_the_number_that_the_vehicle_gives() -> None:
    jump = task(177, 3.0, 2.0)
    assert value_of(jump, field(jump, "number"), first=1) == "4"
    assert changed(jump, "number", "4", first=1).params[0] == 3.0
    assert change_field(jump, field(jump, "number"), "0", first=1) == "there is no item 0"


@pytest.mark.parametrize(
    ("of", "label", "text", "fault"),
    [
        (item(16), "latitude", "90.1", "latitude is -90 to 90"),
        (item(16), "longitude", "-180.5", "longitude is -180 to 180"),
        (item(16), "latitude", "nan", "latitude must be a number"),
        (item(16), "latitude", "inf", "'inf' is too large"),
        (item(16), "hold", "-1", "hold is 0 or more s"),
        (item(16), "hold", "1e39", "'1e39' is too large"),
        (item(16), "hold", "two", "'two' is not a number"),
        (item(16), "altitude", "--", "the altitude must be a number"),
        (task(181), "instance", "1.5", "instance is a whole number"),
        (task(31_999), "param5", "9e9", "param5 is too large"),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line(of: PlanItem, label: str, text: str, fault: str) -> None:
    assert change_field(of, field(of, label), text) == fault


@given(st.text(max_size=12))
def test_no_text_breaks_a_field(text: str) -> None:
    for of in (item(16), task(177), task(31_999)):
        for each in fields_of(of)[1:]:
            found = change_field(of, each, text)
            assert isinstance(found, PlanItem) or (found and "\n" not in found)


@given(st.floats(-(2.0**127), 2.0**127, width=32))
def test_a_float32_comes_back_from_its_text(value: float) -> None:
    of = task(31_999, value)
    text = value_of(of, field(of, "param1"))
    assert len(text) < 16
    assert changed(of, "param1", text).params[0] == value


def test_short_numbers() -> None:
    assert [number_text(value) for value in (0.0, 10.0, 0.6000000238418579, 1e-9)] == ["0", "10", "0.6", "1e-09"]


@pytest.mark.parametrize(
    ("text", "command"),
    [("waypoint", 16), ("NAV_WAYPOINT", 16), ("MAV_CMD_NAV_LOITER_TIME", 19), ("rtl", 20), ("speed", 178),
     ("jump", 177), ("relay", 181), ("servo", 183), ("delay", 112), ("roi", 201), ("loiter turns", 18),
     ("31999", 31999)],
)  # fmt: skip
def test_commands_are_found_by_what_is_typed(text: str, command: int) -> None:
    assert find_command(text, MISSION) == command


def test_a_command_that_is_not_clear_lists_what_there_is() -> None:
    assert find_command("loiter_t", MISSION) == "several commands: NAV_LOITER_TIME, NAV_LOITER_TURNS, NAV_LOITER_TO_ALT"
    assert find_command("fly me to the moon", MISSION) == "no command is called 'fly me to the moon'"
    assert find_command("70000", MISSION) == "70000 is not a command of this plan"
    assert find_command("16", FENCE) == "16 is not a command of this plan"
    assert find_command("circle out", FENCE) == 5004
    assert find_command("waypoint", RALLY) == "the only command of this plan is rally point"


def test_names_for_tables() -> None:
    assert [command_title(command) for command in (16, 178, 5003, 31_999)] == [
        "WAYPOINT", "DO_CHANGE_SPEED", "circle in", "command 31999",
    ]  # fmt: skip
    assert [short_title(command) for command in (16, 20, 178, 206)] == [
        "waypoint",
        "RTL",
        "speed",
        "set_cam_trigg_dist",
    ]


def test_another_command_keeps_the_place_where_it_has_one() -> None:
    waypoint = item(16, 5, 6, 9.0)
    loiter = change_command(waypoint, 19)
    assert (loiter.x, loiter.y, loiter.frame, loiter.params[0]) == (waypoint.x, waypoint.y, 3, 0.0)
    speed = change_command(waypoint, 178)
    assert (speed.x, speed.y, speed.frame) == (0, 0, 2)
    assert change_command(speed, 16).frame == 3
