"""The mission protocol: the old plan stays until the new one is whole and valid, whoever sends what."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.core import Received
from link.services.mission import REMEMBER, MissionServer
from link.services.mission_client import TRIES, Job, MissionClient, MissionOutcome
from link.services.mission_items import NOWHERE, ItemRule, Items, MissionItem, Place, PlanRules
from link.services.mission_upload import ASK_AGAIN, GIVE_UP
from tests.link.services_world import OTHER_PEER, PEER, Pair, from_gcs, from_vehicle, messages

NAV_WAYPOINT, NAV_LOITER_TIME, DO_JUMP, FENCE_CIRCLE = 16, 19, 177, 5003
RULES = {
    MissionType.MISSION: PlanRules(
        {
            NAV_WAYPOINT: ItemRule(Place.NEEDED),
            NAV_LOITER_TIME: ItemRule(Place.OPTIONAL, {1: (0.0, 3600.0)}),
            DO_JUMP: ItemRule(ranges={1: (0, 99), 2: (-1, 100)}),
        },
        capacity=300,
        check=lambda items: (
            MissionResult.ACCEPTED
            if all(item.params[0] < len(items) for item in items if item.command == DO_JUMP)
            else MissionResult.INVALID_PARAM1
        ),
    ),
    MissionType.FENCE: PlanRules({FENCE_CIRCLE: ItemRule(Place.NEEDED, {1: (1, 1000)})}, capacity=10),
    MissionType.RALLY: PlanRules({5100: ItemRule(Place.NEEDED)}, capacity=10),
}


def waypoint(number: int = 0, **changes: Any) -> MissionItem:
    values: dict[str, Any] = {
        "command": NAV_WAYPOINT,
        "frame": 3,
        "params": (0.0, 1.0, 0.0, math.nan),
        "x": 473977420 + number * 100,
        "y": 85455940,
        "z": 0.5,
    }
    return MissionItem(**(values | changes))


def plain(items: Items) -> list[str]:
    """Items as text: NaN is not equal to itself."""
    return [repr(item) for item in items]


@dataclass
class Vehicle:
    """A server, and what it told its vehicle."""

    verdict: MissionResult = MissionResult.ACCEPTED
    changes: list[tuple[MissionType, int]] = field(default_factory=list)
    selected: list[int] = field(default_factory=list)
    at: int = 0

    def __post_init__(self) -> None:
        self.server = MissionServer(self, RULES, system=1, component=1)

    def may_write(self, received: Received, kind: MissionType, now: float) -> MissionResult:
        return self.verdict

    def changed(self, kind: MissionType, items: Items, now: float) -> None:
        self.changes.append((kind, len(items)))

    def select(self, sequence: int, received: Received, now: float) -> None:
        self.selected.append(sequence)
        self.at = sequence

    def current(self) -> m.MissionCurrent:
        return m.MissionCurrent(self.at)

    def ask(self, message: m.Message, now: float = 0.0, **who: Any) -> list[Any]:
        return messages(self.server.receive(from_gcs(message, **who), now))

    def give(self, item: MissionItem, sequence: int, now: float = 0.0, kind: int = 0, **who: Any) -> list[Any]:
        return self.ask(item_int(item, sequence, kind), now, **who)

    def tick(self, now: float) -> list[Any]:
        return messages(self.server.tick(now))

    @property
    def plan(self) -> Items:
        return self.server.plan(MissionType.MISSION)

    def upload(self, items: list[MissionItem]) -> None:
        self.ask(m.MissionCount(1, 1, len(items)))
        for sequence, item in enumerate(items):
            self.give(item, sequence)


def item_int(item: MissionItem, sequence: int, kind: int = 0) -> m.MissionItemInt:
    return m.MissionItemInt(1, 1, sequence, item.frame, item.command, 0, 1, *item.params, item.x, item.y, item.z, kind)


# ---- uploading ----


def test_an_upload_is_asked_for_item_by_item() -> None:
    vehicle = Vehicle()
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
    vehicle = Vehicle()
    [outgoing] = vehicle.server.receive(from_gcs(m.MissionCount(1, 1, 1)), 0.0)
    assert outgoing.peer == PEER


def test_an_item_in_floats_is_the_same_item() -> None:
    vehicle = Vehicle()
    vehicle.ask(m.MissionCount(1, 1, 1))
    old = m.MissionItem(1, 1, 0, 3, NAV_WAYPOINT, 0, 1, 0.0, 1.0, 0.0, math.nan, 47.25, -8.5, 0.5)
    assert [ack.type for ack in vehicle.ask(old)] == [MissionResult.ACCEPTED]
    assert (vehicle.plan[0].latitude, vehicle.plan[0].longitude) == (47.25, -8.5)


def test_an_empty_plan_clears() -> None:
    vehicle = Vehicle()
    vehicle.upload([waypoint()])
    assert [ack.type for ack in vehicle.ask(m.MissionCount(1, 1, 0))] == [MissionResult.ACCEPTED]
    assert vehicle.plan == ()


def test_too_many_items_are_no_space() -> None:
    vehicle = Vehicle()
    vehicle.upload([waypoint()])
    assert [ack.type for ack in vehicle.ask(m.MissionCount(1, 1, 65535))] == [MissionResult.NO_SPACE]
    assert len(vehicle.plan) == 1
    assert vehicle.tick(100.0) == []


def test_silence_is_asked_again_and_then_cancelled_and_the_old_plan_stays() -> None:
    vehicle = Vehicle()
    vehicle.upload([waypoint()])
    vehicle.ask(m.MissionCount(1, 1, 5), 10.0)
    asked: list[tuple[float, Any]] = []
    for step in range(1, 500):
        now = 10.0 + step * 0.02
        asked += [(now, message) for message in vehicle.tick(now)]
    *requests, (at, ack) = asked
    assert [round(now - 10.0, 2) for now, _ in requests[:3]] == pytest.approx([ASK_AGAIN, 2 * ASK_AGAIN, 3 * ASK_AGAIN])
    assert {type(message) for _, message in requests} == {m.MissionRequest, m.MissionRequestInt}
    assert {message.seq for _, message in requests} == {0}
    assert ack.type == MissionResult.CANCELLED
    assert at == pytest.approx(10.0 + GIVE_UP, abs=0.03)
    assert plain(vehicle.plan) == plain((waypoint(),))
    assert vehicle.give(waypoint(7), 0, 20.0) == []


def test_an_item_out_of_order_is_dropped_and_the_right_one_asked_for() -> None:
    vehicle = Vehicle()
    vehicle.ask(m.MissionCount(1, 1, 3), 0.0)
    vehicle.give(waypoint(0), 0, 0.1)
    assert vehicle.give(waypoint(0), 0, 0.11) == [], "a repeat is no reason to ask"
    [again] = vehicle.give(waypoint(2), 2, 0.4)
    assert again.seq == 1
    vehicle.give(waypoint(1), 1, 0.5)
    [ack] = vehicle.give(waypoint(2), 2, 0.6)
    assert ack.type == MissionResult.ACCEPTED
    assert plain(vehicle.plan) == plain((waypoint(0), waypoint(1), waypoint(2)))


def test_the_last_item_said_again_is_acknowledged_again() -> None:
    vehicle = Vehicle()
    vehicle.upload([waypoint(0), waypoint(1)])
    assert [ack.type for ack in vehicle.give(waypoint(1), 1, 1.0)] == [MissionResult.ACCEPTED]
    assert vehicle.give(waypoint(0), 0, 1.0) == []
    assert vehicle.give(waypoint(1), 1, REMEMBER + 1.0) == []
    assert len(vehicle.changes) == 1


def test_items_of_another_ground_station_do_not_count() -> None:
    vehicle = Vehicle()
    vehicle.ask(m.MissionCount(1, 1, 1), 0.0)
    assert vehicle.give(waypoint(9), 0, 0.1, system=254) == []
    assert vehicle.give(waypoint(9), 0, 0.1, peer=OTHER_PEER) == []
    assert vehicle.plan == ()
    vehicle.give(waypoint(0), 0, 0.2)
    assert plain(vehicle.plan) == plain((waypoint(0),))


def test_a_second_sender_is_denied_while_one_is_busy_and_the_first_may_begin_again() -> None:
    vehicle = Vehicle()
    vehicle.ask(m.MissionCount(1, 1, 5), 0.0)
    assert [ack.type for ack in vehicle.ask(m.MissionCount(1, 1, 1), 0.1, system=254)] == [MissionResult.DENIED]
    assert [ack.type for ack in vehicle.ask(m.MissionClearAll(1, 1, 0), 0.1, system=254)] == [MissionResult.DENIED]
    assert vehicle.ask(m.MissionCount(1, 1, 1), 0.2)[0].seq == 0
    assert vehicle.give(waypoint(), 0, 0.3)[0].type == MissionResult.ACCEPTED


def test_plans_of_different_kinds_go_up_side_by_side() -> None:
    vehicle = Vehicle()
    vehicle.ask(m.MissionCount(1, 1, 1, MissionType.MISSION))
    vehicle.ask(m.MissionCount(1, 1, 1, MissionType.FENCE), system=254)
    circle = waypoint(command=FENCE_CIRCLE, params=(50.0, 0.0, 0.0, 0.0))
    [ack] = vehicle.give(circle, 0, kind=MissionType.FENCE, system=254)
    assert (ack.type, ack.mission_type) == (MissionResult.ACCEPTED, MissionType.FENCE)
    vehicle.give(waypoint(), 0)
    assert vehicle.changes == [(MissionType.FENCE, 1), (MissionType.MISSION, 1)]


@pytest.mark.parametrize("verdict", [MissionResult.DENIED, MissionResult.ERROR])
def test_the_vehicle_may_refuse_to_be_changed(verdict: MissionResult) -> None:
    vehicle = Vehicle()
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
    ("changes", "verdict"),
    [
        ({"command": 0}, MissionResult.UNSUPPORTED),
        ({"command": 22}, MissionResult.UNSUPPORTED),
        ({"command": 65535}, MissionResult.UNSUPPORTED),
        ({"frame": 99}, MissionResult.UNSUPPORTED_FRAME),
        ({"frame": 2}, MissionResult.UNSUPPORTED_FRAME),
        ({"x": 900000001}, MissionResult.INVALID_X),
        ({"x": -900000001}, MissionResult.INVALID_X),
        ({"x": NOWHERE}, MissionResult.INVALID_X),
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
def test_an_invalid_item_ends_the_upload_and_says_which_field(changes: dict[str, Any], verdict: MissionResult) -> None:
    vehicle = Vehicle()
    vehicle.upload([waypoint(5)])
    vehicle.ask(m.MissionCount(1, 1, 1))
    [ack] = vehicle.give(waypoint(**changes), 0, 0.1)
    assert (type(ack), ack.type) == (m.MissionAck, verdict)
    assert plain(vehicle.plan) == plain((waypoint(5),))
    assert [each.type for each in vehicle.give(waypoint(**changes), 0, 0.2)] == [verdict], "its answer may get lost"


@pytest.mark.parametrize("latitude", [math.nan, math.inf, -math.inf, 1e30, 91.0])
def test_a_latitude_in_floats_that_is_none(latitude: float) -> None:
    vehicle = Vehicle()
    vehicle.ask(m.MissionCount(1, 1, 1))
    old = m.MissionItem(1, 1, 0, 3, NAV_WAYPOINT, 0, 1, 0.0, 0.0, 0.0, 0.0, latitude, 8.5, 0.5)
    assert [ack.type for ack in vehicle.ask(old)] == [MissionResult.INVALID_X]


def test_here_is_a_place_where_a_command_allows_it() -> None:
    vehicle = Vehicle()
    vehicle.upload([waypoint(command=NAV_LOITER_TIME, params=(5.0, 0.0, 0.0, 0.0), x=0, y=0)])
    assert len(vehicle.plan) == 1


@pytest.mark.parametrize(
    ("system", "component", "introduced"), [(2, 1, True), (0, 0, True), (1, 42, True), (1, 1, False)]
)
def test_what_is_meant_for_others_or_comes_from_strangers_is_not_answered(
    system: int, component: int, introduced: bool
) -> None:
    vehicle = Vehicle()
    assert vehicle.ask(m.MissionCount(system, component, 1), introduced=introduced) == []
    assert vehicle.ask(m.MissionRequestList(system, component, 0), introduced=introduced) == []
    assert vehicle.tick(1.0) == []


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


# ---- both halves ----


def ending(client: MissionClient, pair: Pair, within: float) -> MissionOutcome:
    outcomes: list[MissionOutcome] = []

    def ended() -> bool:
        outcomes.extend(client.outcomes())
        return bool(outcomes)

    pair.run_until(ended, within)
    [outcome] = outcomes
    return outcome


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 10_000), st.sampled_from([0.0, 0.1, 0.3]), st.integers(0, 40))
def test_a_plan_goes_up_and_down_whatever_is_lost(seed: int, loss: float, length: int) -> None:
    vehicle = Vehicle()
    client = MissionClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client, loss=loss, seed=seed)
    items = [waypoint(number) for number in range(length)]
    client.upload(items, MissionType.MISSION, pair.now)
    assert ending(client, pair, within=200.0).done
    assert plain(vehicle.plan) == plain(tuple(items))
    client.download(MissionType.MISSION, pair.now)
    outcome = ending(client, pair, within=200.0)
    assert outcome.done
    assert plain(outcome.items) == plain(tuple(items))
    client.clear(MissionType.MISSION, pair.now)
    assert ending(client, pair, within=30.0).done
    assert vehicle.plan == ()


def test_two_hundred_items_take_a_round_trip_each() -> None:
    vehicle = Vehicle()
    client = MissionClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client)
    client.upload([waypoint(number) for number in range(200)], MissionType.MISSION, pair.now)
    assert pair.run_until(lambda: not client.busy, within=20.0) < 201 * 0.06
    assert (pair.sent_by_client, pair.sent_by_server) == (201, 201)


def test_a_refusal_is_told_with_its_reason() -> None:
    vehicle = Vehicle()
    client = MissionClient(255, 190, target_system=1)
    client.upload([waypoint(command=22)], MissionType.MISSION, 100.0)
    outcome = ending(client, Pair(vehicle.server, client), within=5.0)
    assert (outcome.job, outcome.done, outcome.result) == (Job.UPLOAD, False, MissionResult.UNSUPPORTED)


def test_an_old_answer_said_again_ends_no_new_job() -> None:
    client = MissionClient(255, 190, target_system=1)
    accepted = from_vehicle(m.MissionAck(255, 190, MissionResult.ACCEPTED, 0))
    client.upload([waypoint(0), waypoint(1)], MissionType.MISSION, 0.0)
    client.receive(accepted, 0.1)
    assert client.outcomes() == []
    client.download(MissionType.MISSION, 0.2)
    client.receive(accepted, 0.3)
    assert client.outcomes() == []


def test_silence_ends_too() -> None:
    client = MissionClient(255, 190, target_system=1)
    client.download(MissionType.RALLY, 0.0)
    sent = []
    for tenth in range(300):
        client.tick(tenth / 10)
        sent += client.messages_to_send()
    assert len(sent) == TRIES
    assert [(outcome.result, outcome.kind) for outcome in client.outcomes()] == [(None, MissionType.RALLY)]


def test_words_of_other_vehicles_and_to_others_do_not_count() -> None:
    client = MissionClient(255, 190, target_system=1)
    client.clear(MissionType.MISSION, 0.0)
    client.receive(from_vehicle(m.MissionAck(255, 190, 0, 0), system=2), 0.1)
    client.receive(from_vehicle(m.MissionAck(254, 190, 0, 0)), 0.1)
    client.receive(from_vehicle(m.MissionAck(255, 190, 0, 1)), 0.1)
    assert client.outcomes() == []
    client.receive(from_vehicle(m.MissionAck(255, 190, 0, 0)), 0.1)
    assert len(client.outcomes()) == 1


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
