"""LOITER in a simulated field."""

from __future__ import annotations

from dialects.enums import Result
from dialects.modes import Mode
from tests.vehicle.field import away


def test_loiter_stays_and_comes_back_when_moved() -> None:
    field = away()
    assert field.set_mode(Mode.LOITER) is Result.ACCEPTED
    here = field.truth
    assert field.stands_for(2.0)
    assert field.body is not None
    field.body.motion.north += 2.5
    field.beat(60.0)  # the filter hides a jump for some time, as it hides a GPS that jumps
    assert field.truth.distance(here) < 1.5
