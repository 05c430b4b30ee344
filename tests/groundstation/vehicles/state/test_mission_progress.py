"""Where a mission stands, with and without its plan."""

from __future__ import annotations

import pytest

from dialects import messages as m
from groundstation.geo import METRES_PER_DEGREE, Place
from groundstation.snapshot.drive import MissionProgress
from groundstation.vehicles.state.mission_progress import MissionMessages
from link.services.mission.items import MissionItem

WAYPOINT, LOITER_TIME, CHANGE_SPEED = 16, 19, 178
GLOBAL, MISSION = 6, 2
STEP = 10 / METRES_PER_DEGREE
"""10 m of latitude, degrees."""


def item(command: int, metres_north: float | None, wait: float = 0.0) -> MissionItem:
    if metres_north is None:
        return MissionItem(command, MISSION, (1.0, 2.0, 0.0, 0.0), 0, 0, 0.0)
    latitude = 47.0 + metres_north / METRES_PER_DEGREE
    return MissionItem(command, GLOBAL, (wait, 0.0, 0.0, 0.0), round(latitude * 1e7), round(8.0 * 1e7), 0.0)


PLAN = (
    item(WAYPOINT, 10.0), item(CHANGE_SPEED, None), item(LOITER_TIME, 30.0, 10.0), item(WAYPOINT, 60.0),
)  # fmt: skip
HERE = Place(47.0 + 20.0 / METRES_PER_DEGREE, 8.0)


def progress(
    *messages: m.Message, plan: tuple[MissionItem, ...] = (), here: Place | None = None, speed: float | None = 0.5,
    navigates: bool = True, at: float = 10.0,
) -> MissionProgress | None:  # fmt: skip
    state = MissionMessages()
    for message in messages:
        state.receive(message, 10.0)
    return state.build(plan, here, speed, navigates=navigates, now=at)


def current(seq: int, total: int) -> m.MissionCurrent:
    return m.MissionCurrent(seq, total)


def test_without_a_mission_there_is_nothing() -> None:
    assert progress() is None
    assert progress(current(0, 0xFFFF)) is None, "the vehicle says that there is none"
    assert progress(current(0, 0)) is None, "it does not tell"


def test_with_the_plan_distances_are_those_of_its_places() -> None:
    found = progress(current(2, 4), plan=PLAN, here=HERE)
    assert found is not None
    assert (found.current, found.last, found.command) == (2, 3, "LOITER_TIME 10 s")
    assert found.distance == pytest.approx(10.0, abs=0.1)
    assert found.left == pytest.approx(40.0, abs=0.1)
    assert found.time_left == pytest.approx(80.0, abs=0.2)
    assert found.legs == pytest.approx((20.0, 30.0), abs=0.1)
    assert found.places == (2, 3), "where each leg ends"


def test_an_item_without_a_place_is_on_the_way_to_the_next_one() -> None:
    found = progress(current(1, 4), plan=PLAN, here=HERE)
    assert found is not None
    assert found.distance == pytest.approx(10.0, abs=0.1)
    assert found.command == "DO_CHANGE_SPEED"


def test_without_the_plan_the_vehicle_tells_how_far_it_is() -> None:
    messages = current(2, 4), m.NavControllerOutput(0.0, 0.0, 0, 0, 12, 0.0, 0.0, 0.0)
    found = progress(*messages, here=HERE)
    assert found == MissionProgress(current=2, last=3, distance=12.0)
    assert progress(*messages, navigates=False) == MissionProgress(current=2, last=3), "it drives elsewhere"
    assert progress(*messages, at=20.0) == MissionProgress(current=2, last=3), "that was long ago"


def test_who_stands_or_is_driven_by_hand_has_no_time_to_go() -> None:
    for changes in ({"speed": 0.0}, {"speed": None}, {"navigates": False}):
        found = progress(current(2, 4), plan=PLAN, here=HERE, **changes)
        assert found is not None
        assert found.left == pytest.approx(40.0, abs=0.1)
        assert found.time_left is None
