"""Local and global coordinates, and angles."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle.navigation.geo import Origin, Point, wrap_angle

METRES = st.floats(-1000.0, 1000.0)


@given(METRES, METRES, st.floats(-80.0, 80.0), st.floats(-180.0, 180.0))
def test_global_coordinates_convert_back(north: float, east: float, latitude: float, longitude: float) -> None:
    origin = Origin(latitude, longitude)
    assert origin.to_local(*origin.to_global(Point(north, east))) == pytest.approx((north, east), abs=1e-3)


def test_the_antimeridian_is_no_edge() -> None:
    assert Origin(0.0, 179.9999).to_local(0.0, -179.9999).east == pytest.approx(22.3, abs=0.1)


def test_distance_and_bearing_belong_to_the_offset() -> None:
    here = Point(3.0, -4.0)
    there = here.offset(math.radians(120), 25.0)
    assert here.distance(there) == pytest.approx(25.0)
    assert here.bearing(there) == pytest.approx(math.radians(120))


@pytest.mark.parametrize(("angle", "wrapped"), [(0.5, 0.5), (math.tau + 0.5, 0.5), (-4.0, math.tau - 4.0)])
def test_angles_wrap(angle: float, wrapped: float) -> None:
    assert wrap_angle(angle) == pytest.approx(wrapped)
