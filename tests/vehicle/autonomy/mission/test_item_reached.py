"""MISSION_ITEM_REACHED is repeated until another item is done or the mission changes."""

from __future__ import annotations

from dialects import messages as m
from link.core import Outgoing
from tests.vehicle.field import Field
from tests.vehicle.missions import finish, ready, start, upload, way
from vehicle.autonomy.mission.item_reached import SEND_COUNT, SEND_PERIOD, ItemReachedSender


def sequences(outgoing: list[Outgoing]) -> list[int]:
    return [each.message.seq for each in outgoing if isinstance(each.message, m.MissionItemReached)]


def test_the_message_is_sent_at_once_and_repeated() -> None:
    reached = ItemReachedSender()
    assert reached.tick([], 0.0) == []
    assert sequences(reached.tick([3], 1.0)) == [3]
    said = [step * 0.02 for step in range(51, 500) if reached.tick([], step * 0.02)]
    assert len(said) == SEND_COUNT - 1
    assert said[0] - 1.0 >= SEND_PERIOD
    assert said[1] - said[0] >= SEND_PERIOD


def test_only_the_newest_item_is_repeated() -> None:
    reached = ItemReachedSender()
    reached.tick([3], 0.0)
    assert sequences(reached.tick([4, 5], SEND_PERIOD)) == [4, 5]
    assert sequences(reached.tick([], 2 * SEND_PERIOD)) == [5]


def test_a_reset_stops_the_repetition() -> None:
    reached = ItemReachedSender()
    reached.tick([3], 0.0)
    reached.reset()
    assert reached.tick([], 10.0) == []


def finished() -> Field:
    """A mission of one item, just complete."""
    field = ready(way(3, 0))
    start(field)
    finish(field, 30.0)
    assert [each.seq for each in field.all(m.MissionItemReached)] == [0]
    return field


def test_a_finished_mission_repeats_its_message() -> None:
    field = finished()
    field.beat(3.0)
    assert [each.seq for each in field.all(m.MissionItemReached)] == [0] * SEND_COUNT


def test_a_new_mission_stops_the_repetition() -> None:
    field = finished()
    upload(field, way(3, 0), way(0, 0))
    field.beat(3.0)
    assert len(field.all(m.MissionItemReached)) == 1


def test_choosing_another_item_stops_the_repetition() -> None:
    field = finished()
    field.say(m.MissionSetCurrent(1, 1, 0))
    field.beat(3.0)
    assert len(field.all(m.MissionItemReached)) == 1
