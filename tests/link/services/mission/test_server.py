"""The mission protocol of the vehicle: reading, clearing, choosing, and a part of a plan."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.services.mission.items import UNSET_COORDINATE, ItemRequest
from tests.link.mission_rig import (
    DO_JUMP,
    FENCE_CIRCLE,
    MissionRig,
    plain,
    waypoint,
)
from tests.link.services_world import from_gcs

# ---- a part ----


def test_a_part_of_a_plan_is_replaced() -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(number) for number in range(4)])
    [request] = vehicle.ask(m.MissionWritePartialList(1, 1, 1, 2))
    assert request.seq == 1
    vehicle.give(waypoint(21), 1)
    [ack] = vehicle.give(waypoint(22), 2)
    assert ack.type == MissionResult.ACCEPTED
    assert plain(vehicle.plan) == plain((waypoint(0), waypoint(21), waypoint(22), waypoint(3)))


@pytest.mark.parametrize(("first", "last"), [(-1, 0), (0, 2), (1, 0), (5, 5), (-32768, 32767)])
def test_a_part_must_lie_inside_the_plan(first: int, last: int) -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(0), waypoint(1)])
    answers = vehicle.ask(m.MissionWritePartialList(1, 1, first, last))
    assert [ack.type for ack in answers] == [MissionResult.INVALID_SEQUENCE]


def test_a_part_that_breaks_the_rules_leaves_the_plan() -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(0), waypoint(1), waypoint(2, command=DO_JUMP, params=(1.0, 2.0, 0.0, 0.0))])
    vehicle.ask(m.MissionWritePartialList(1, 1, 2, 2))
    [ack] = vehicle.give(waypoint(2, command=DO_JUMP, params=(7.0, 2.0, 0.0, 0.0)), 2)
    assert (ack.type, ack.opaque_id) == (MissionResult.INVALID_PARAM1, 0)
    assert vehicle.plan[2].params[0] == 1.0


# ---- downloading, clearing, choosing ----


@pytest.mark.parametrize("kind", [3, 200, 255])
def test_unknown_kinds_are_unsupported(kind: int) -> None:
    for message in (
        m.MissionRequestList(1, 1, kind),
        m.MissionCount(1, 1, 1, kind),
        m.MissionRequestInt(1, 1, 0, kind),
    ):
        assert [ack.type for ack in MissionRig().ask(message)] == [MissionResult.UNSUPPORTED]


def test_clearing_one_kind_and_all_of_them() -> None:
    vehicle = MissionRig()
    circle = waypoint(command=FENCE_CIRCLE, params=(50.0, 0.0, 0.0, 0.0))
    for kind, item in ((MissionType.MISSION, waypoint()), (MissionType.FENCE, circle)):
        assert vehicle.server.load(kind, [item]) is MissionResult.ACCEPTED
    assert vehicle.ask(m.MissionClearAll(1, 1, 0))[0].type == MissionResult.ACCEPTED
    assert (len(vehicle.plan), len(vehicle.server.plan(MissionType.FENCE))) == (0, 1)
    assert vehicle.ask(m.MissionClearAll(1, 1, 255))[0].type == MissionResult.ACCEPTED
    assert vehicle.server.plan(MissionType.FENCE) == ()


def test_clearing_ends_an_upload_of_ones_own() -> None:
    vehicle = MissionRig()
    vehicle.ask(m.MissionCount(1, 1, 2))
    vehicle.ask(m.MissionClearAll(1, 1, 0))
    assert vehicle.give(waypoint(), 0) == []
    assert vehicle.tick(100.0) == []


def test_whoever_uploads_may_end_it_and_nobody_else() -> None:
    vehicle = MissionRig()
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
    vehicle = MissionRig()
    vehicle.upload([waypoint(0), waypoint(1)])
    [outgoing] = vehicle.server.receive(from_gcs(m.MissionSetCurrent(1, 1, 1)), 0.0)
    assert isinstance(outgoing.message, m.MissionCurrent)
    assert (outgoing.message.seq, outgoing.peer, vehicle.selected) == (1, None, [1])


# ---- items that are not part of a plan ----


def lone(current: int, target: int = 1, component: int = 1, kind: int = 0) -> m.MissionItemInt:
    item = waypoint(7)
    ids = (target, component, 0, item.frame, item.command, current, 0)
    return m.MissionItemInt(*ids, *item.params, item.x, item.y, item.z, kind)


@pytest.mark.parametrize("request_", [ItemRequest.DRIVE_TO, ItemRequest.CHANGE_ALTITUDE])
@pytest.mark.parametrize("verdict", [MissionResult.ACCEPTED, MissionResult.ERROR])
def test_a_lone_item_is_passed_on_and_acknowledged(request_: ItemRequest, verdict: MissionResult) -> None:
    vehicle = MissionRig(verdict)
    [ack] = vehicle.ask(lone(request_))
    assert (ack.type, ack.mission_type, ack.opaque_id) == (verdict, MissionType.MISSION, 0)
    assert (ack.target_system, ack.target_component) == (255, 190)
    [(request, item)] = vehicle.requests
    assert request is request_
    assert plain((item,)) == plain((waypoint(7, autocontinue=False),))
    assert (vehicle.plan, vehicle.changes) == ((), [])


def test_a_lone_item_with_floats_is_the_same_request() -> None:
    vehicle = MissionRig()
    message = m.MissionItem(1, 1, 0, 3, 16, 2, 0, 0, 0, 0, 0, 47.5, 8.25, 0)
    assert [ack.type for ack in vehicle.ask(message)] == [MissionResult.ACCEPTED]
    [(request, item)] = vehicle.requests
    assert (request, item.x, item.y) == (ItemRequest.DRIVE_TO, 475_000_000, 82_500_000)


def test_a_lone_item_to_all_is_handled_and_one_to_another_is_not() -> None:
    """DroneKit's simple_goto sends target system 0."""
    vehicle = MissionRig()
    assert len(vehicle.ask(lone(2, target=0, component=0))) == 1
    assert vehicle.ask(lone(2, target=2)) == []
    assert vehicle.ask(lone(2, component=100)) == []
    assert vehicle.ask(lone(0, target=0)) == []
    assert len(vehicle.requests) == 1


def test_lone_item_of_a_sender_without_heartbeat_is_not_answered() -> None:
    vehicle = MissionRig()
    assert vehicle.ask(lone(2), introduced=False) == []
    assert vehicle.requests == []


def test_a_lone_item_is_no_part_of_an_upload_of_its_sender() -> None:
    vehicle = MissionRig()
    vehicle.ask(m.MissionCount(1, 1, 1))
    assert [type(answer) for answer in vehicle.ask(lone(2))] == [m.MissionAck]
    assert vehicle.plan == ()
    [ack] = vehicle.give(waypoint(5), 0)
    assert ack.type == MissionResult.ACCEPTED
    assert plain(vehicle.plan) == plain((waypoint(5),))
    assert len(vehicle.requests) == 1


def test_a_current_of_2_in_a_fence_is_an_item_of_the_upload() -> None:
    """Only items of missions may be requests, as in ArduPilot."""
    vehicle = MissionRig()
    vehicle.ask(m.MissionCount(1, 1, 1, MissionType.FENCE))
    circle = waypoint(command=FENCE_CIRCLE, params=(50.0, 0.0, 0.0, 0.0))
    place = (circle.x, circle.y, circle.z)
    [ack] = vehicle.ask(m.MissionItemInt(1, 1, 0, 3, FENCE_CIRCLE, 2, 1, *circle.params, *place, MissionType.FENCE))
    assert ack.type == MissionResult.ACCEPTED
    assert (len(vehicle.server.plan(MissionType.FENCE)), vehicle.requests) == (1, [])


def test_a_saved_plan_passes_the_same_rules() -> None:
    vehicle = MissionRig()
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
        *(st.integers(0, 4), st.integers(0, 1), *[st.floats(width=32)] * 7, st.integers(0, 3)),
    ),
)


@given(st.lists(WORDS, max_size=30))
def test_nothing_that_is_said_raises(words: list[m.Message]) -> None:
    vehicle = MissionRig()
    for number, word in enumerate(words):
        vehicle.ask(word, number * 0.3)
        vehicle.tick(number * 0.3)
