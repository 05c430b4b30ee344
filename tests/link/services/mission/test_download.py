"""Downloads of a plan: single items, and a range at once."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import MissionResult
from link.core import Peer
from link.services.mission.download import MAX_CLIENTS
from link.services.pacing import BulkPacer
from tests.link.mission_rig import (
    MissionRig,
    waypoint,
)


@pytest.mark.parametrize(
    ("first", "last", "told"), [(1, 2, [1, 2]), (2, 2, [2]), (0, 3, [0, 1, 2, 3]), (0, -1, [0, 1, 2, 3]), (3, -1, [3])]
)
def test_a_part_of_a_plan_is_told_without_more_questions(first: int, last: int, told: list[int]) -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(number) for number in range(4)])
    assert vehicle.ask(m.MissionRequestPartialList(1, 1, first, last)) == []
    items = vehicle.tick(1.0)
    assert [item.seq for item in items] == told
    assert [item.x for item in items] == [waypoint(number).x for number in told]
    assert vehicle.tick(2.0) == []


def test_a_large_part_goes_no_faster_than_the_line() -> None:
    vehicle = MissionRig(pacer=BulkPacer(lambda peer: 1000.0))
    vehicle.upload([waypoint(number) for number in range(100)])
    vehicle.ask(m.MissionRequestPartialList(1, 1, 0, -1))
    told = [item.seq for cycle in range(100) for item in vehicle.tick(cycle * 0.02)]
    assert 30 < len(told) < 60  # 2 s of 1000 bytes/s, 50 bytes an item
    assert told == sorted(told)
    told += [item.seq for cycle in range(100, 400) for item in vehicle.tick(cycle * 0.02)]
    assert told == list(range(100))


@pytest.mark.parametrize(
    ("first", "last", "kind", "verdict"),
    [
        (-1, 0, 0, MissionResult.INVALID_SEQUENCE),
        (0, 2, 0, MissionResult.INVALID_SEQUENCE),
        (1, 0, 0, MissionResult.INVALID_SEQUENCE),
        (0, -2, 0, MissionResult.INVALID_SEQUENCE),
        (0, -1, 1, MissionResult.INVALID_SEQUENCE),
        (0, 0, 9, MissionResult.UNSUPPORTED),
    ],
)
def test_no_part_of_what_is_not_there(first: int, last: int, kind: int, verdict: MissionResult) -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(0), waypoint(1)])
    [ack] = vehicle.ask(m.MissionRequestPartialList(1, 1, first, last, kind))
    assert ack.type == verdict
    assert vehicle.tick(1.0) == []


def test_a_newer_question_replaces_the_former_and_there_are_few() -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(0), waypoint(1), waypoint(2)])
    vehicle.ask(m.MissionRequestPartialList(1, 1, 0, 1))
    vehicle.ask(m.MissionRequestPartialList(1, 1, 2, 2))
    assert [item.seq for item in vehicle.tick(1.0)] == [2]
    asked = [
        vehicle.ask(m.MissionRequestPartialList(1, 1, 0, 0), peer=Peer(0, number)) for number in range(MAX_CLIENTS + 1)
    ]
    assert [len(each) for each in asked] == [0] * MAX_CLIENTS + [1]
    assert asked[-1][0].type == MissionResult.DENIED


def test_a_plan_is_read_item_by_item_in_either_words() -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(0), waypoint(1)])
    vehicle.at = 1
    [count] = vehicle.ask(m.MissionRequestList(1, 1, 0))
    assert (count.count, count.mission_type, count.target_system) == (2, 0, 255)
    for question in (m.MissionRequestInt(1, 1, 1, 0), m.MissionRequest(1, 1, 1, 0)):
        [item] = vehicle.ask(question)
        assert (type(item), item.seq, item.x, item.current) == (m.MissionItemInt, 1, waypoint(1).x, 1)
    assert vehicle.ask(m.MissionRequestInt(1, 1, 0, 0))[0].current == 0


@pytest.mark.parametrize("kind", [0, 1, 2])
def test_no_plan_is_a_count_of_zero(kind: int) -> None:
    assert [count.count for count in MissionRig().ask(m.MissionRequestList(1, 1, kind))] == [0]


def test_an_item_beyond_the_end_is_an_invalid_sequence() -> None:
    assert [ack.type for ack in MissionRig().ask(m.MissionRequestInt(1, 1, 0, 0))] == [MissionResult.INVALID_SEQUENCE]
