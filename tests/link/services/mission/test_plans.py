"""Ids of plans: one plan has one id, on every vehicle and in every release."""

from __future__ import annotations

import math
import struct
from typing import Any

import pytest

from dialects import messages as m
from dialects.enums import MissionType
from link.services.mission.files import decode_plan, encode_plan
from link.services.mission.plans import plan_id
from tests.link.mission_rig import (
    NAV_LOITER_TIME,
    MissionRig,
    waypoint,
)

PINNED = 1059710445
"""plan_id of one plain waypoint."""


def test_the_id_is_told_at_the_end_of_an_upload_and_on_download() -> None:
    vehicle = MissionRig()
    vehicle.ask(m.MissionCount(1, 1, 1, opaque_id=77))
    [ack] = vehicle.give(waypoint(0), 0)
    [count] = vehicle.ask(m.MissionRequestList(1, 1, 0))
    assert ack.opaque_id == count.opaque_id == vehicle.server.plan_id(MissionType.MISSION) not in (0, 77)


def test_the_id_changes_with_the_plan_and_only_with_it() -> None:
    vehicle, seen = MissionRig(), []
    for items in ([waypoint(0)], [waypoint(1)], [waypoint(0), waypoint(1)], [waypoint(1), waypoint(0)], [waypoint(0)]):
        vehicle.upload(items)
        seen.append(vehicle.server.plan_id(MissionType.MISSION))
    assert seen[0] == seen[4]
    assert len(set(seen)) == 4
    vehicle.ask(m.MissionWritePartialList(1, 1, 0, 0))
    [ack] = vehicle.give(waypoint(0, z=9.0), 0)
    assert ack.opaque_id not in (0, *seen)
    assert vehicle.server.plan_id(MissionType.FENCE) == 0
    [cleared] = vehicle.ask(m.MissionClearAll(1, 1, 0))
    [count] = vehicle.ask(m.MissionRequestList(1, 1, 0))
    assert (cleared.opaque_id, count.opaque_id, vehicle.server.plan_id(MissionType.MISSION)) == (0, 0, 0)


@pytest.mark.parametrize(
    "changes",
    [
        *({"command": NAV_LOITER_TIME}, {"frame": 6}, {"params": (1.0, 1.0, 0.0, math.nan)}, {"x": 1}, {"y": 1}),
        *({"z": 0.6}, {"autocontinue": False}),
    ],
)
def test_every_field_counts_for_the_id(changes: dict[str, Any]) -> None:
    assert plan_id([waypoint(0)]) != plan_id([waypoint(0, **changes)])


def test_the_id_never_changes_from_release_to_release() -> None:
    # A ground station may know a plan by it for years.
    assert (plan_id([]), plan_id([waypoint(0)])) == (0, PINNED)
    other_nan = struct.unpack("<f", b"\x01\x00\xc0\xff")[0]
    assert plan_id([waypoint(0, params=(0.0, 1.0, 0.0, other_nan))]) == PINNED


def test_a_plan_has_the_same_id_after_the_way_through_a_file() -> None:
    items = [waypoint(0, z=0.1), waypoint(1, params=(0.3, math.nan, -1e-9, 5.0))]
    vehicle = MissionRig()
    vehicle.upload(items)
    assert plan_id(decode_plan(encode_plan(vehicle.plan))) == vehicle.server.plan_id(MissionType.MISSION)
