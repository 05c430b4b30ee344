"""Validation of items: which MISSION_ACK an invalid one gets."""

from __future__ import annotations

import math
from typing import Any

import pytest

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.services.mission.items import UNSET_COORDINATE
from tests.link.mission_rig import (
    DO_JUMP,
    NAV_LOITER_TIME,
    NAV_WAYPOINT,
    MissionRig,
    plain,
    waypoint,
)
from tests.rows import each_row


@each_row(
    ("changes", "verdict"),
    [
        ({"command": 0}, MissionResult.UNSUPPORTED),
        ({"command": 22}, MissionResult.UNSUPPORTED),
        ({"command": 65535}, MissionResult.UNSUPPORTED),
        ({"frame": 99}, MissionResult.UNSUPPORTED_FRAME),
        ({"frame": 2}, MissionResult.UNSUPPORTED_FRAME),
        ({"x": 900000001}, MissionResult.INVALID_X),
        ({"x": -900000001}, MissionResult.INVALID_X),
        ({"x": UNSET_COORDINATE}, MissionResult.INVALID_X),
        ({"x": 0, "y": 0}, MissionResult.INVALID_X),
        ({"y": 1800000001}, MissionResult.INVALID_Y),
        ({"params": (math.inf, 0.0, 0.0, 0.0)}, MissionResult.INVALID_PARAM1),
        ({"params": (0.0, 0.0, 0.0, -math.inf)}, MissionResult.INVALID_PARAM4),
        ({"z": math.inf}, MissionResult.INVALID_PARAM7),
        ({"command": NAV_LOITER_TIME, "params": (math.nan, 0.0, 0.0, 0.0)}, MissionResult.INVALID_PARAM1),
        ({"command": NAV_LOITER_TIME, "params": (-1.0, 0.0, 0.0, 0.0)}, MissionResult.INVALID_PARAM1),
        ({"command": DO_JUMP, "params": (0.0, 101.0, 0.0, 0.0)}, MissionResult.INVALID_PARAM2),
        ({"command": DO_JUMP, "params": (9.0, 1.0, 0.0, 0.0), "frame": 2}, MissionResult.INVALID_PARAM1),
    ],
)
def test_68_an_invalid_item_ends_the_upload_and_says_which_field(
    changes: dict[str, Any], verdict: MissionResult
) -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(5)])
    vehicle.ask(m.MissionCount(1, 1, 1))
    [ack] = vehicle.give(waypoint(**changes), 0, 0.1)
    assert (type(ack), ack.type) == (m.MissionAck, verdict)
    assert plain(vehicle.plan) == plain((waypoint(5),))
    assert [each.type for each in vehicle.give(waypoint(**changes), 0, 0.2)] == [verdict], "its answer may get lost"
    as_a_whole = changes.get("params", (0.0,))[0] == 9.0
    assert vehicle.unfits == [(MissionType.MISSION, None if as_a_whole else 0, verdict)]


@pytest.mark.parametrize("latitude", [math.nan, math.inf, -math.inf, 1e30, 91.0])
def test_68_a_latitude_in_floats_that_is_none(latitude: float) -> None:
    vehicle = MissionRig()
    vehicle.ask(m.MissionCount(1, 1, 1))
    old = m.MissionItem(1, 1, 0, 3, NAV_WAYPOINT, 0, 1, 0.0, 0.0, 0.0, 0.0, latitude, 8.5, 0.5)
    assert [ack.type for ack in vehicle.ask(old)] == [MissionResult.INVALID_X]


def test_here_is_a_place_where_a_command_allows_it() -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(command=NAV_LOITER_TIME, params=(5.0, 0.0, 0.0, 0.0), x=0, y=0)])
    assert len(vehicle.plan) == 1
