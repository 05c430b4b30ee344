"""The mission protocol of the vehicle: reading, clearing, choosing, and a part of a plan."""

from __future__ import annotations

import math
import struct
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.core import Peer
from link.services.mission.download import MAX_CLIENTS
from link.services.mission.files import decode_plan, encode_plan
from link.services.mission.items import UNSET_COORDINATE
from link.services.mission.plans import plan_id
from link.services.pacing import BulkPacer
from tests.link.mission_vehicle import (
    DO_JUMP,
    FENCE_CIRCLE,
    NAV_LOITER_TIME,
    Vehicle,
    plain,
    waypoint,
)
from tests.link.services_world import from_gcs

PINNED = 1059710445
"""plan_id of one plain waypoint."""

# ---- a part ----


def test_a_part_of_a_plan_is_replaced() -> None:
    vehicle = Vehicle()
    vehicle.upload([waypoint(number) for number in range(4)])
    [request] = vehicle.ask(m.MissionWritePartialList(1, 1, 1, 2))
    assert request.seq == 1
    vehicle.give(waypoint(21), 1)
    [ack] = vehicle.give(waypoint(22), 2)
    assert ack.type == MissionResult.ACCEPTED
    assert plain(vehicle.plan) == plain((waypoint(0), waypoint(21), waypoint(22), waypoint(3)))


@pytest.mark.parametrize(("first", "last"), [(-1, 0), (0, 2), (1, 0), (5, 5), (-32768, 32767)])
def test_a_part_must_lie_inside_the_plan(first: int, last: int) -> None:
    vehicle = Vehicle()
    vehicle.upload([waypoint(0), waypoint(1)])
    answers = vehicle.ask(m.MissionWritePartialList(1, 1, first, last))
    assert [ack.type for ack in answers] == [MissionResult.INVALID_SEQUENCE]


def test_a_part_that_breaks_the_rules_leaves_the_plan() -> None:
    vehicle = Vehicle()
    vehicle.upload([waypoint(0), waypoint(1), waypoint(2, command=DO_JUMP, params=(1.0, 2.0, 0.0, 0.0))])
    vehicle.ask(m.MissionWritePartialList(1, 1, 2, 2))
    [ack] = vehicle.give(waypoint(2, command=DO_JUMP, params=(7.0, 2.0, 0.0, 0.0)), 2)
    assert (ack.type, ack.opaque_id) == (MissionResult.INVALID_PARAM1, 0)
    assert vehicle.plan[2].params[0] == 1.0


@pytest.mark.parametrize(
    ("first", "last", "told"), [(1, 2, [1, 2]), (2, 2, [2]), (0, 3, [0, 1, 2, 3]), (0, -1, [0, 1, 2, 3]), (3, -1, [3])]
)
def test_a_part_of_a_plan_is_told_without_more_questions(first: int, last: int, told: list[int]) -> None:
    vehicle = Vehicle()
    vehicle.upload([waypoint(number) for number in range(4)])
    assert vehicle.ask(m.MissionRequestPartialList(1, 1, first, last)) == []
    items = vehicle.tick(1.0)
    assert [item.seq for item in items] == told
    assert [item.x for item in items] == [waypoint(number).x for number in told]
    assert vehicle.tick(2.0) == []


def test_a_large_part_goes_no_faster_than_the_line() -> None:
    vehicle = Vehicle(pacer=BulkPacer(lambda peer: 1000.0))
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
    vehicle = Vehicle()
    vehicle.upload([waypoint(0), waypoint(1)])
    [ack] = vehicle.ask(m.MissionRequestPartialList(1, 1, first, last, kind))
    assert ack.type == verdict
    assert vehicle.tick(1.0) == []


def test_a_newer_question_replaces_the_one_before_and_there_are_not_too_many() -> None:
    vehicle = Vehicle()
    vehicle.upload([waypoint(0), waypoint(1), waypoint(2)])
    vehicle.ask(m.MissionRequestPartialList(1, 1, 0, 1))
    vehicle.ask(m.MissionRequestPartialList(1, 1, 2, 2))
    assert [item.seq for item in vehicle.tick(1.0)] == [2]
    asked = [
        vehicle.ask(m.MissionRequestPartialList(1, 1, 0, 0), peer=Peer(0, number)) for number in range(MAX_CLIENTS + 1)
    ]
    assert [len(each) for each in asked] == [0] * MAX_CLIENTS + [1]
    assert asked[-1][0].type == MissionResult.DENIED


# ---- ids ----


def test_the_id_is_told_at_the_end_of_an_upload_and_on_download() -> None:
    vehicle = Vehicle()
    vehicle.ask(m.MissionCount(1, 1, 1, opaque_id=77))
    [ack] = vehicle.give(waypoint(0), 0)
    [count] = vehicle.ask(m.MissionRequestList(1, 1, 0))
    assert ack.opaque_id == count.opaque_id == vehicle.server.plan_id(MissionType.MISSION) not in (0, 77)


def test_the_id_changes_with_the_plan_and_only_with_it() -> None:
    vehicle, seen = Vehicle(), []
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
    vehicle = Vehicle()
    vehicle.upload(items)
    assert plan_id(decode_plan(encode_plan(vehicle.plan))) == vehicle.server.plan_id(MissionType.MISSION)


# ---- downloading, clearing, choosing ----


def test_a_plan_is_read_item_by_item_in_either_words() -> None:
    vehicle = Vehicle()
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
    assert [count.count for count in Vehicle().ask(m.MissionRequestList(1, 1, kind))] == [0]


@pytest.mark.parametrize("kind", [3, 200, 255])
def test_unknown_kinds_are_unsupported(kind: int) -> None:
    for message in (
        m.MissionRequestList(1, 1, kind),
        m.MissionCount(1, 1, 1, kind),
        m.MissionRequestInt(1, 1, 0, kind),
    ):
        assert [ack.type for ack in Vehicle().ask(message)] == [MissionResult.UNSUPPORTED]


def test_an_item_beyond_the_end_is_an_invalid_sequence() -> None:
    assert [ack.type for ack in Vehicle().ask(m.MissionRequestInt(1, 1, 0, 0))] == [MissionResult.INVALID_SEQUENCE]


def test_clearing_one_kind_and_all_of_them() -> None:
    vehicle = Vehicle()
    circle = waypoint(command=FENCE_CIRCLE, params=(50.0, 0.0, 0.0, 0.0))
    for kind, item in ((MissionType.MISSION, waypoint()), (MissionType.FENCE, circle)):
        assert vehicle.server.load(kind, [item]) is MissionResult.ACCEPTED
    assert vehicle.ask(m.MissionClearAll(1, 1, 0))[0].type == MissionResult.ACCEPTED
    assert (len(vehicle.plan), len(vehicle.server.plan(MissionType.FENCE))) == (0, 1)
    assert vehicle.ask(m.MissionClearAll(1, 1, 255))[0].type == MissionResult.ACCEPTED
    assert vehicle.server.plan(MissionType.FENCE) == ()


def test_clearing_ends_an_upload_of_ones_own() -> None:
    vehicle = Vehicle()
    vehicle.ask(m.MissionCount(1, 1, 2))
    vehicle.ask(m.MissionClearAll(1, 1, 0))
    assert vehicle.give(waypoint(), 0) == []
    assert vehicle.tick(100.0) == []


def test_whoever_uploads_may_end_it_and_nobody_else() -> None:
    vehicle = Vehicle()
    vehicle.upload([waypoint(9)])
    vehicle.ask(m.MissionCount(1, 1, 2))
    stop = m.MissionAck(1, 1, MissionResult.CANCELLED)
    vehicle.ask(stop, system=254)
    vehicle.ask(m.MissionAck(1, 1, MissionResult.ACCEPTED))
    [request] = vehicle.give(waypoint(0), 0)
    assert request.seq == 1
    vehicle.ask(stop)
    assert vehicle.give(waypoint(1), 1) == []
    assert vehicle.tick(100.0) == []
    assert plain(vehicle.plan) == plain((waypoint(9),))


def test_choosing_an_item_is_answered_to_all() -> None:
    vehicle = Vehicle()
    vehicle.upload([waypoint(0), waypoint(1)])
    [outgoing] = vehicle.server.receive(from_gcs(m.MissionSetCurrent(1, 1, 1)), 0.0)
    assert isinstance(outgoing.message, m.MissionCurrent)
    assert (outgoing.message.seq, outgoing.peer, vehicle.selected) == (1, None, [1])


def test_a_saved_plan_passes_the_same_rules() -> None:
    vehicle = Vehicle()
    assert vehicle.server.load(MissionType.MISSION, [waypoint(x=UNSET_COORDINATE)]) is MissionResult.INVALID_X
    assert vehicle.server.load(MissionType.FENCE, [waypoint()] * 11) is MissionResult.NO_SPACE
    assert vehicle.plan == ()
    assert vehicle.changes == []


WORDS = st.one_of(
    st.builds(m.MissionCount, st.just(1), st.just(1), st.integers(0, 65535), st.integers(0, 255)),
    st.builds(m.MissionRequestInt, st.just(1), st.just(1), st.integers(0, 65535), st.integers(0, 255)),
    st.builds(m.MissionRequestPartialList, st.just(1), st.just(1), *[st.integers(-9, 9)] * 2, st.integers(0, 3)),
    st.builds(m.MissionAck, st.just(1), st.just(1), st.integers(0, 255), st.integers(0, 255)),
    st.builds(m.MissionWritePartialList, st.just(1), st.just(1), *[st.integers(-32768, 32767)] * 2, st.integers(0, 3)),
    st.builds(m.MissionClearAll, st.just(1), st.just(1), st.integers(0, 255)),
    st.builds(
        m.MissionItem,
        *(st.just(1), st.just(1), st.integers(0, 3), st.integers(0, 255), st.integers(0, 65535)),
        *(st.integers(0, 1), st.integers(0, 1), *[st.floats(width=32)] * 7, st.integers(0, 3)),
    ),
)


@given(st.lists(WORDS, max_size=30))
def test_nothing_that_is_said_raises(words: list[m.Message]) -> None:
    vehicle = Vehicle()
    for number, word in enumerate(words):
        vehicle.ask(word, number * 0.3)
        vehicle.tick(number * 0.3)
