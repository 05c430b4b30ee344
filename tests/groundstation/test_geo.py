"""Places on earth and metres around them."""

from __future__ import annotations

import math

import pytest

from groundstation.geo import LocalFrame, Place, bearing, find_separation, is_on_earth, keep_on_earth


@pytest.mark.parametrize(
    ("end", "distance", "bearing"),
    [
        (Place(10.001, 20.0), 111.3, 0.0),
        (Place(10.0, 20.001), 109.6, 90.0),
        (Place(9.999, 20.0), 111.3, 180.0),
        (Place(10.0, 19.999), 109.6, 270.0),
        (Place(10.0, 20.0), 0.0, 0.0),
    ],
)
def test_ways(end: Place, distance: float, bearing: float) -> None:
    way = find_separation(Place(10.0, 20.0), end)
    assert way is not None
    assert tuple(way) == pytest.approx((distance, bearing), abs=0.1)


def test_across_the_date_line_the_way_is_short() -> None:
    way = find_separation(Place(0.0, 179.9995), Place(0.0, -179.9995))
    assert way is not None
    assert tuple(way) == pytest.approx((111.3, 90.0), abs=0.1)


def test_without_both_places_there_is_no_way() -> None:
    assert find_separation(None, Place(1.0, 1.0)) is None
    assert find_separation(Place(1.0, 1.0), None) is None


def test_metres_around_a_place_and_back() -> None:
    frame = LocalFrame(Place(60.0, 10.0))
    assert frame.to_point(Place(60.0, 10.0)) == (0.0, 0.0)
    assert frame.to_point(Place(60.001, 10.001)) == pytest.approx((111.32, 55.66), abs=0.01)
    assert frame.to_point(frame.to_place((12.5, -7.25))) == pytest.approx((12.5, -7.25), abs=1e-6)
    assert bearing((0, 0), (0, 5)) == 90.0


def test_the_date_line() -> None:
    frame = LocalFrame(Place(10.0, 179.9999))
    assert frame.to_point(Place(10.0, -179.9999)) == pytest.approx((0.0, 21.9), abs=0.1)
    assert frame.to_place((0.0, 50.0)).longitude < 0


def test_the_pole_has_finite_places_and_nothing_is_beyond_it() -> None:
    beyond = LocalFrame(Place(90.0, 0.0)).to_place((100.0, 100.0))
    assert all(map(math.isfinite, beyond))
    assert not is_on_earth(*beyond)
    assert keep_on_earth(beyond).latitude == 90.0
    assert not is_on_earth(math.nan, 0.0)
