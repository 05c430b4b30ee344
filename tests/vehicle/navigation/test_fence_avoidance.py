"""What drives by itself stops before the fence: the geometry, and a rover in a simulated field."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from dialects import messages as m
from dialects.enums import DriveLimit, FenceItem, MissionResult, MissionType, Result
from dialects.modes import Mode
from tests.vehicle.autonomy.mission.test_mission import Item, finish, ready, start, upload, way
from tests.vehicle.bench import AHEAD, NEUTRAL, said
from tests.vehicle.field import Field
from tests.vehicle.navigation.test_fence import square
from vehicle.navigation.fence_area import FenceArea
from vehicle.navigation.geo import Point

METRES = st.floats(-50.0, 50.0)
PLACES = st.builds(Point, METRES, METRES)
SHAPES: dict[str, list[Item]] = {
    "inclusion polygon": square(FenceItem.POLYGON_INCLUSION, -5, -5, 11),
    "exclusion polygon": square(FenceItem.POLYGON_EXCLUSION, 6, -3, 6),
    "inclusion circle": [(FenceItem.CIRCLE_INCLUSION, Point(0, 0), (6,))],
    "exclusion circle": [(FenceItem.CIRCLE_EXCLUSION, Point(9, 0), (3,))],
}
"""Each has its edge 6 m north of home."""
EDGE = 6.0


# ---- geometry ----


@given(
    st.one_of(
        st.builds(FenceArea, st.tuples(PLACES), st.floats(0.5, 40.0), st.booleans()),
        st.builds(FenceArea, st.lists(PLACES, min_size=3, max_size=8).map(tuple), st.just(0.0), st.booleans()),
    ),
    PLACES,
    st.floats(-7.0, 7.0),
    st.floats(0.0, 1.0),
)
def test_no_edge_is_nearer_than_the_one_ahead(area: FenceArea, place: Point, course: float, share: float) -> None:
    ahead = area.distance_ahead(place, course)
    before = min(ahead, 300.0) * share * 0.999
    side = math.copysign(1.0, area.distance_to_edge(place))
    assume(abs(area.distance_to_edge(place)) > 1e-6)
    on_the_way = area.distance_to_edge(place.offset(course, before))
    assert on_the_way * side > -1e-6, "it has crossed an edge before the one ahead"


@given(st.builds(FenceArea, st.tuples(PLACES), st.floats(0.5, 40.0), st.booleans()), PLACES, st.floats(-7.0, 7.0))
def test_the_edge_ahead_is_one(area: FenceArea, place: Point, course: float) -> None:
    ahead = area.distance_ahead(place, course)
    assume(ahead < math.inf)
    assert area.distance_to_edge(place.offset(course, ahead)) == pytest.approx(0.0, abs=1e-3)


def test_a_course_along_an_edge_meets_the_next_one() -> None:
    corners = (Point(0, 0), Point(10, 0), Point(10, 10), Point(0, 10))
    assert FenceArea(corners, 0.0, inclusion=True).distance_ahead(Point(2, 0), 0.0) == pytest.approx(8.0)
    assert FenceArea(corners, 0.0, inclusion=False).distance_ahead(Point(-5, 5), math.pi) == math.inf


# ---- the rover ----


def fenced(items: list[Item], **params: float) -> Field:
    field = Field(FENCE_ENABLE=1, FENCE_TYPE=4, **params)  # type: ignore[arg-type]
    assert upload(field, *items, kind=MissionType.FENCE) == MissionResult.ACCEPTED
    return field


@pytest.mark.parametrize("items", SHAPES.values(), ids=SHAPES.keys())
def test_a_velocity_toward_the_fence_ends_before_it(items: list[Item]) -> None:
    field = fenced(items)
    field.begin(Mode.GUIDED)
    field.stream(3.0, 0.8)
    assert field.speed > 0.6
    field.stream(12.0, 0.8)
    assert field.truth.north == pytest.approx(EDGE - 1.0, abs=0.6)
    assert abs(field.speed) < 0.05
    assert field.mode is Mode.GUIDED
    field.wait(0.2)
    assert field.newest(m.RoverDriveStatus).limits & DriveLimit.FENCE
    field.stream(6.0, -0.5)  # and back it may go at once
    assert field.truth.north < EDGE - 2.5
    assert not field.newest(m.RoverDriveStatus).limits & DriveLimit.FENCE


def test_backwards_it_stops_as_well() -> None:
    field = fenced([(FenceItem.CIRCLE_INCLUSION, Point(0, 0), (5,))])
    field.begin(Mode.GUIDED)
    field.stream(14.0, -0.8)
    assert field.truth.north == pytest.approx(-4.0, abs=0.6)


@pytest.mark.parametrize("params", [{"AVOID_ENABLE": 0}, {"FENCE_ACTION": 0}])
def test_where_it_is_turned_off_it_drives_on(params: dict[str, float]) -> None:
    field = fenced([(FenceItem.CIRCLE_INCLUSION, Point(0, 0), (5,))], **params)
    field.begin(Mode.GUIDED)
    field.stream(12.0, 0.8)
    assert field.truth.north > 5.0
    assert said(field, "outside the fence")


@pytest.mark.parametrize(("margin", "north"), [(0, 5.0), (2, 3.0)])
def test_the_margin_is_a_setting(margin: float, north: float) -> None:
    field = fenced([(FenceItem.CIRCLE_INCLUSION, Point(0, 0), (5,))], FENCE_MARGIN=margin)
    field.begin(Mode.GUIDED)
    field.stream(12.0, 0.8)
    assert field.truth.north == pytest.approx(north, abs=0.6)


def test_a_driver_is_not_held_back() -> None:
    field = fenced([(FenceItem.CIRCLE_INCLUSION, Point(0, 0), (5,))])
    field.arm()
    field.wait(0.2, NEUTRAL)
    field.wait(6.0, AHEAD)
    assert field.truth.north > 4.8
    assert said(field, "outside the fence: HOLD")


@pytest.mark.parametrize(
    ("place", "why"),
    [(Point(8, 0), "outside the fence"), (Point(5.5, 0), "closer to the fence than FENCE_MARGIN")],
)
def test_no_place_there_is_driven_to(place: Point, why: str) -> None:
    field = fenced(SHAPES["inclusion circle"])
    field.begin(Mode.GUIDED)
    assert field.reposition(place) is Result.FAILED
    field.wait(1.0)
    assert said(field, "DO_REPOSITION refused: ")
    assert said(field, why)
    field.goto(*place)
    field.wait(1.0)
    assert any("Setpoint" in text and why in text for text in field.texts)
    assert field.stands_for(1.0)
    assert field.reposition(Point(4, 0)) is Result.ACCEPTED


def test_a_mission_ends_before_an_item_that_lies_beyond() -> None:
    field = ready(way(3, 0), way(3, 3), way(20, 0), FENCE_ENABLE=1, FENCE_TYPE=2, FENCE_RADIUS=8)
    start(field)
    finish(field, 60.0)
    assert said(field, "AUTO: item 2: outside the fence: HOLD")
    assert field.truth.distance(Point(3, 3)) < 1.0
    field.wait(1.1)
    told = field.newest(m.MissionCurrent)
    assert (told.seq, told.mission_state) == (2, m.MISSION_PAUSED)
    assert field.set_mode(Mode.AUTO) is Result.ACCEPTED
    field.beat(1.0)
    assert field.mode is Mode.HOLD


def test_a_way_through_a_forbidden_area_ends_before_it() -> None:
    field = fenced(SHAPES["exclusion circle"])
    assert upload(field, way(20, 0)) == MissionResult.ACCEPTED
    field.arm()
    start(field)
    finish(field, 60.0)
    assert said(field, "AUTO: blocked by the fence: HOLD")
    assert field.truth.north == pytest.approx(EDGE - 1.0, abs=0.6)


def test_beyond_the_fence_the_way_home_is_free() -> None:
    field = fenced([(FenceItem.CIRCLE_INCLUSION, Point(0, 0), (5,))], FENCE_ACTION=1)
    field.arm()
    field.wait(0.2, NEUTRAL)
    field.wait(7.0, AHEAD)
    assert field.mode is Mode.RTL
    finish(field, 60.0)
    assert field.truth.distance(Point(0, 0)) < 0.8
