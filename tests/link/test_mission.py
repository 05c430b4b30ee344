"""The mission protocol of the vehicle: reading, clearing, choosing, and a part of a plan."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.services.mission_items import NOWHERE
from tests.link.mission_vehicle import (
    FENCE_CIRCLE,
    Vehicle,
    plain,
    waypoint,
)
from tests.link.services_world import from_gcs

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


def test_choosing_an_item_is_answered_to_all() -> None:
    vehicle = Vehicle()
    vehicle.upload([waypoint(0), waypoint(1)])
    [outgoing] = vehicle.server.receive(from_gcs(m.MissionSetCurrent(1, 1, 1)), 0.0)
    assert isinstance(outgoing.message, m.MissionCurrent)
    assert (outgoing.message.seq, outgoing.peer, vehicle.selected) == (1, None, [1])


def test_a_saved_plan_passes_the_same_rules() -> None:
    vehicle = Vehicle()
    assert vehicle.server.load(MissionType.MISSION, [waypoint(x=NOWHERE)]) is MissionResult.INVALID_X
    assert vehicle.server.load(MissionType.FENCE, [waypoint()] * 11) is MissionResult.NO_SPACE
    assert vehicle.plan == ()
    assert vehicle.changes == []


WORDS = st.one_of(
    st.builds(m.MissionCount, st.just(1), st.just(1), st.integers(0, 65535), st.integers(0, 255)),
    st.builds(m.MissionRequestInt, st.just(1), st.just(1), st.integers(0, 65535), st.integers(0, 255)),
    st.builds(m.MissionWritePartialList, st.just(1), st.just(1), *[st.integers(-32768, 32767)] * 2, st.integers(0, 3)),
    st.builds(m.MissionClearAll, st.just(1), st.just(1), st.integers(0, 255)),
    st.builds(
        m.MissionItem,
        *(st.just(1), st.just(1), st.integers(0, 3), st.integers(0, 255), st.integers(0, 65535)),
        *(st.integers(0, 1), st.integers(0, 1), *[st.floats(width=32)] * 7, st.integers(0, 3)),
    ),
)


@settings(deadline=None)
@given(st.lists(WORDS, max_size=30))
def test_nothing_that_is_said_raises(words: list[m.Message]) -> None:
    vehicle = Vehicle()
    for number, word in enumerate(words):
        vehicle.ask(word, number * 0.3)
        vehicle.tick(number * 0.3)
