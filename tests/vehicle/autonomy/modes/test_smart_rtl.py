"""SMART_RTL in a simulated field."""

from __future__ import annotations

from dialects.enums import Result
from dialects.modes import Mode
from tests.vehicle.field import away
from vehicle.navigation.geo import Point

HOME = Point(0.0, 0.0)


def test_smart_rtl_goes_back_the_way_it_came() -> None:
    field = away()
    corner = max(field.track, key=lambda place: place.north - place.east)
    field.track.clear()
    assert field.set_mode(Mode.SMART_RTL) is Result.ACCEPTED
    field.until(HOME, 90.0, 0.9)
    field.beat(6.0)
    assert field.mode is Mode.HOLD
    assert min(place.distance(corner) for place in field.track) < 1.0
