"""RTL in a simulated field; the choice of the return point is in tests/vehicle/navigation/test_rally.py."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Command, ModeFlag, Result
from dialects.modes import Mode
from tests.vehicle.bench import said
from tests.vehicle.field import away
from vehicle.navigation.geo import Point

HOME = Point(0.0, 0.0)


def test_rtl_goes_home_and_ends_in_hold() -> None:
    field = away()
    assert field.command(Command.NAV_RETURN_TO_LAUNCH) is Result.ACCEPTED
    assert field.newest(m.Heartbeat).base_mode & ModeFlag.AUTO
    field.until(HOME, 60.0, 0.6)
    field.beat(4.0)
    assert field.mode is Mode.HOLD
    assert said(field, "home is reached: HOLD")
    assert field.truth.distance(HOME) < 0.8
    assert field.stands_for(2.0)
