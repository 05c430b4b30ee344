"""Uploading a plan: the old one stays until the new one is whole and valid, whoever sends what."""

from __future__ import annotations

import math
from typing import Any

import pytest

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.core import Outgoing
from link.services.mission.upload import REPEAT_WINDOW, REQUEST_TIMEOUT, UPLOAD_TIMEOUT
from tests.link.mission_rig import (
    FENCE_CIRCLE,
    NAV_WAYPOINT,
    MissionRig,
    item_int,
    plain,
    waypoint,
)
from tests.link.services_world import OTHER_PEER, PEER, from_gcs


def test_an_upload_is_asked_for_item_by_item() -> None:
    vehicle = MissionRig()
    [first] = vehicle.ask(m.MissionCount(1, 1, 2))
    assert isinstance(first, m.MissionRequestInt)
    assert (first.seq, first.target_system, first.target_component, first.mission_type) == (0, 255, 190, 0)
    [second] = vehicle.give(waypoint(0), 0)
    assert (type(second), second.seq) == (m.MissionRequestInt, 1)
    assert vehicle.plan == ()
    [ack] = vehicle.give(waypoint(1), 1)
    assert (type(ack), ack.type, ack.target_system) == (m.MissionAck, MissionResult.ACCEPTED, 255)
    assert plain(vehicle.plan) == plain((waypoint(0), waypoint(1)))
    assert vehicle.changes == [(MissionType.MISSION, 2)]


def test_answers_go_to_who_asked() -> None:
    vehicle = MissionRig()
    [outgoing] = vehicle.server.receive(from_gcs(m.MissionCount(1, 1, 1)), 0.0)
    assert outgoing.peer == PEER


def test_an_item_in_floats_is_the_same_item() -> None:
    vehicle = MissionRig()
    vehicle.ask(m.MissionCount(1, 1, 1))
    old = m.MissionItem(1, 1, 0, 3, NAV_WAYPOINT, 0, 1, 0.0, 1.0, 0.0, math.nan, 47.25, -8.5, 0.5)
    assert [ack.type for ack in vehicle.ask(old)] == [MissionResult.ACCEPTED]
    assert (vehicle.plan[0].latitude, vehicle.plan[0].longitude) == (47.25, -8.5)


def test_an_empty_plan_clears() -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint()])
    assert [ack.type for ack in vehicle.ask(m.MissionCount(1, 1, 0))] == [MissionResult.ACCEPTED]
    assert vehicle.plan == ()


def test_65_too_many_items_are_no_space() -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint()])
    assert [ack.type for ack in vehicle.ask(m.MissionCount(1, 1, 65535))] == [MissionResult.NO_SPACE]
    assert len(vehicle.plan) == 1
    assert vehicle.tick(100.0) == []


def test_66_silence_is_asked_again_then_cancelled_and_plan_stays() -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint()])
    vehicle.ask(m.MissionCount(1, 1, 5), 10.0)
    asked: list[tuple[float, Any]] = []
    for step in range(1, 500):
        now = 10.0 + step * 0.02
        asked += [(now, message) for message in vehicle.tick(now)]
    *requests, (at, ack) = asked
    assert [round(now - 10.0, 2) for now, _ in requests[:3]] == pytest.approx(
        [REQUEST_TIMEOUT, 2 * REQUEST_TIMEOUT, 3 * REQUEST_TIMEOUT]
    )
    assert {type(message) for _, message in requests} == {m.MissionRequest, m.MissionRequestInt}
    assert {message.seq for _, message in requests} == {0}
    assert ack.type == MissionResult.CANCELLED
    assert at == pytest.approx(10.0 + UPLOAD_TIMEOUT, abs=0.03)
    assert plain(vehicle.plan) == plain((waypoint(),))
    assert vehicle.give(waypoint(7), 0, 20.0) == []


def test_who_refuses_floats_is_asked_in_integers_from_then_on() -> None:
    """As MAVSDK does: its refusal is not a wish to end."""
    vehicle = MissionRig()
    vehicle.ask(m.MissionCount(1, 1, 2))
    [old] = vehicle.tick(REQUEST_TIMEOUT)
    assert isinstance(old, m.MissionRequest)
    refusal = m.MissionAck(1, 1, MissionResult.UNSUPPORTED)
    assert [type(each) for each in vehicle.ask(refusal, now=REQUEST_TIMEOUT)] == [m.MissionRequestInt]
    assert vehicle.ask(refusal, now=REQUEST_TIMEOUT) == []
    for again in range(2, 6):
        assert [type(each) for each in vehicle.tick(again * REQUEST_TIMEOUT)] == [m.MissionRequestInt]
    vehicle.give(waypoint(0), 0)
    assert [ack.type for ack in vehicle.give(waypoint(1), 1)] == [MissionResult.ACCEPTED]


def test_unsupported_ends_an_upload_asked_for_in_integers() -> None:
    vehicle = MissionRig()
    vehicle.ask(m.MissionCount(1, 1, 2))
    assert vehicle.ask(m.MissionAck(1, 1, MissionResult.UNSUPPORTED)) == []
    assert vehicle.give(waypoint(0), 0) == []


def test_67_item_out_of_order_is_dropped_and_the_right_one_asked() -> None:
    vehicle = MissionRig()
    vehicle.ask(m.MissionCount(1, 1, 3), 0.0)
    vehicle.give(waypoint(0), 0, 0.1)
    assert vehicle.give(waypoint(0), 0, 0.11) == [], "a repeat is not a reason to ask"
    [again] = vehicle.give(waypoint(2), 2, 0.4)
    assert again.seq == 1
    vehicle.give(waypoint(1), 1, 0.5)
    [ack] = vehicle.give(waypoint(2), 2, 0.6)
    assert ack.type == MissionResult.ACCEPTED
    assert plain(vehicle.plan) == plain((waypoint(0), waypoint(1), waypoint(2)))


def test_67_the_last_item_said_again_is_acknowledged_again() -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(0), waypoint(1)])
    assert [ack.type for ack in vehicle.give(waypoint(1), 1, 1.0)] == [MissionResult.ACCEPTED]
    assert vehicle.give(waypoint(0), 0, 1.0) == []
    assert vehicle.give(waypoint(1), 1, REPEAT_WINDOW + 1.0) == []
    assert len(vehicle.changes) == 1


def test_67_items_of_another_ground_station_do_not_count() -> None:
    vehicle = MissionRig()
    vehicle.ask(m.MissionCount(1, 1, 1), 0.0)
    assert vehicle.give(waypoint(9), 0, 0.1, system=254) == []
    assert vehicle.give(waypoint(9), 0, 0.1, peer=OTHER_PEER) == []
    assert vehicle.plan == ()
    vehicle.give(waypoint(0), 0, 0.2)
    assert plain(vehicle.plan) == plain((waypoint(0),))


def test_a_second_sender_is_denied_and_the_first_may_begin_again() -> None:
    vehicle = MissionRig()
    vehicle.ask(m.MissionCount(1, 1, 5), 0.0)
    assert [ack.type for ack in vehicle.ask(m.MissionCount(1, 1, 1), 0.1, system=254)] == [MissionResult.DENIED]
    assert [ack.type for ack in vehicle.ask(m.MissionClearAll(1, 1, 0), 0.1, system=254)] == [MissionResult.DENIED]
    assert vehicle.ask(m.MissionCount(1, 1, 1), 0.2)[0].seq == 0
    assert vehicle.give(waypoint(), 0, 0.3)[0].type == MissionResult.ACCEPTED


def test_what_may_not_be_changed_any_more_at_the_end_stays() -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(9)])
    vehicle.ask(m.MissionCount(1, 1, 2))
    vehicle.give(waypoint(0), 0)
    vehicle.verdict = MissionResult.DENIED
    assert [(ack.type, ack.opaque_id) for ack in vehicle.give(waypoint(1), 1)] == [(MissionResult.DENIED, 0)]
    assert plain(vehicle.plan) == plain((waypoint(9),))


def test_plans_of_different_kinds_go_up_side_by_side() -> None:
    vehicle = MissionRig()
    vehicle.ask(m.MissionCount(1, 1, 1, MissionType.MISSION))
    vehicle.ask(m.MissionCount(1, 1, 1, MissionType.FENCE), system=254)
    circle = waypoint(command=FENCE_CIRCLE, params=(50.0, 0.0, 0.0, 0.0))
    [ack] = vehicle.give(circle, 0, kind=MissionType.FENCE, system=254)
    assert (ack.type, ack.mission_type) == (MissionResult.ACCEPTED, MissionType.FENCE)
    vehicle.give(waypoint(), 0)
    assert vehicle.changes == [(MissionType.FENCE, 1), (MissionType.MISSION, 1)]


@pytest.mark.parametrize("verdict", [MissionResult.DENIED, MissionResult.ERROR])
def test_the_vehicle_may_refuse_to_be_changed(verdict: MissionResult) -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(0), waypoint(1)])
    vehicle.verdict = verdict
    for message in (
        m.MissionCount(1, 1, 1),
        m.MissionClearAll(1, 1, 0),
        m.MissionClearAll(1, 1, 255),
        m.MissionWritePartialList(1, 1, 0, 1),
    ):
        assert [ack.type for ack in vehicle.ask(message)] == [verdict]
    assert len(vehicle.plan) == 2


@pytest.mark.parametrize(
    ("system", "component", "introduced"), [(2, 1, True), (0, 0, True), (1, 42, True), (1, 1, False)]
)
def test_what_is_for_others_or_from_strangers_is_not_answered(system: int, component: int, introduced: bool) -> None:
    vehicle = MissionRig()
    assert vehicle.ask(m.MissionCount(system, component, 1), introduced=introduced) == []
    assert vehicle.ask(m.MissionRequestList(system, component, 0), introduced=introduced) == []
    assert vehicle.tick(1.0) == []


def only(outgoing: list[Outgoing]) -> Outgoing:
    """The one that there is."""
    [each] = outgoing
    return each


def test_an_upload_goes_on_over_another_link_of_its_sender() -> None:
    vehicle = MissionRig()
    vehicle.ask(m.MissionCount(1, 1, 3))
    vehicle.give(waypoint(0), 0)
    assert vehicle.give(waypoint(0), 0, peer=OTHER_PEER) == []  # it is somebody else
    vehicle.others = [PEER]
    again: Any = only(vehicle.server.receive(from_gcs(item_int(waypoint(0), 0), peer=OTHER_PEER), 0.1))
    assert (again.peer, again.message.seq) == (OTHER_PEER, 1)  # the request on the cut link is lost
    assert vehicle.give(waypoint(0), 0, peer=OTHER_PEER) == []  # once is enough
    vehicle.give(waypoint(1), 1, peer=OTHER_PEER)
    [late] = vehicle.server.tick(0.1 + REQUEST_TIMEOUT)
    assert late.peer == OTHER_PEER
    vehicle.others = [OTHER_PEER]
    done: Any = only(vehicle.server.receive(from_gcs(item_int(waypoint(2), 2)), 0.7))
    assert (done.peer, done.message.type) == (PEER, MissionResult.ACCEPTED)
    vehicle.others = [PEER]
    repeated: Any = only(vehicle.server.receive(from_gcs(item_int(waypoint(2), 2), peer=OTHER_PEER), 0.8))
    assert (repeated.peer, repeated.message.type) == (OTHER_PEER, MissionResult.ACCEPTED)


def test_a_plan_being_saved_is_acknowledged_on_the_new_link() -> None:
    vehicle = MissionRig(disk=[], others=[PEER])
    vehicle.ask(m.MissionCount(1, 1, 1))
    assert vehicle.give(waypoint(0), 0) == []
    assert vehicle.give(waypoint(0), 0, peer=OTHER_PEER) == []
    assert vehicle.disk is not None
    vehicle.disk[0].done = True
    done: Any = only(vehicle.server.tick(0.5))
    assert (done.peer, done.message.type) == (OTHER_PEER, MissionResult.ACCEPTED)
    vehicle.ask(m.MissionClearAll(1, 1, 0))
    vehicle.ask(m.MissionClearAll(1, 1, 0), peer=OTHER_PEER)
    vehicle.disk[1].done = True
    cleared: Any = only(vehicle.server.tick(1.0))
    assert (cleared.peer, cleared.message.type) == (OTHER_PEER, MissionResult.ACCEPTED)
