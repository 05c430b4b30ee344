"""Equality of plan items: of files, of vehicles and of the Map screen."""

from __future__ import annotations

import math
from typing import Any

import pytest
from msgspec.structs import replace

from dialects.command_places import PLACELESS
from groundstation.plan_key import item_key
from groundstation.ui.map.plan.commands import has_location
from groundstation.ui.map.plan.mission_commands import MISSION_COMMANDS
from groundstation.ui.map.plan.rows import item_key as key_of_screen
from groundstation.views.plan import PlanItem
from link.services.mission.items import MissionItem

AS_FLOAT32 = 0.10000000149011612


def item(command: int = 16, **changes: Any) -> MissionItem:
    return replace(MissionItem(command, 3, (0.0, 0.1, 0.0, math.nan), 1, 2, 0.1), **changes)


def same(one: MissionItem, other: MissionItem) -> bool:
    keys = [item_key(each, located=each.command not in PLACELESS) for each in (one, other)]
    equal = keys[0] == keys[1]
    screen = [PlanItem(each.command, each.frame, each.params, each.x, each.y, each.z) for each in (one, other)]
    assert (key_of_screen(screen[0]) == key_of_screen(screen[1])) is equal, "the Map screen judges by the same rule"
    return equal


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (item(), item(params=(0.0, AS_FLOAT32, 0.0, math.nan), z=AS_FLOAT32)),
        (item(frame=6), item(frame=3)),
        (item(178, frame=3), item(178, frame=0)),
        (item(5001, frame=3, z=5.0), item(5001, frame=0, z=0.0)),
        (item(19), item(19, params=(0.0, 0.1, 1.0, math.nan))),
        (item(autocontinue=False), item()),
    ],
    ids=["float32", "frame without INT", "no place, no frame", "fence", "direction of a loiter", "autocontinue"],
)
def test_what_a_vehicle_keeps_is_equal(one: MissionItem, other: MissionItem) -> None:
    assert same(one, other)


@pytest.mark.parametrize(
    "other",
    [
        item(17),
        item(frame=0),
        item(x=3),
        item(z=0.2),
        item(params=(0.0, 0.1, 0.0, 0.0)),
        item(params=(0.0, 0.100001, 0.0, math.nan)),
    ],
    ids=["command", "frame of a place", "place", "altitude", "not set", "next float32"],
)
def test_what_differs_for_a_vehicle_is_not_equal(other: MissionItem) -> None:
    assert not same(item(), other)


def test_screen_and_verbs_agree_which_commands_have_a_place() -> None:
    assert {each for each in MISSION_COMMANDS if not has_location(each)} <= PLACELESS
    assert not {each for each in MISSION_COMMANDS if has_location(each)} & PLACELESS
