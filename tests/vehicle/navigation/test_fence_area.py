"""Geometry of fence areas: distance to the edge, and to the edge on a course."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from vehicle.navigation.fence_area import FenceArea
from vehicle.navigation.geo import Point

METRES = st.floats(-50.0, 50.0)
PLACES = st.builds(Point, METRES, METRES)


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
def test_the_edge_ahead_lies_on_the_boundary(area: FenceArea, place: Point, course: float) -> None:
    ahead = area.distance_ahead(place, course)
    assume(ahead < math.inf)
    assert area.distance_to_edge(place.offset(course, ahead)) == pytest.approx(0.0, abs=1e-3)


def test_a_course_along_an_edge_meets_the_next_one() -> None:
    corners = (Point(0, 0), Point(10, 0), Point(10, 10), Point(0, 10))
    assert FenceArea(corners, 0.0, inclusion=True).distance_ahead(Point(2, 0), 0.0) == pytest.approx(8.0)
    assert FenceArea(corners, 0.0, inclusion=False).distance_ahead(Point(-5, 5), math.pi) == math.inf
