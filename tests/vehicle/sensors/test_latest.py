"""The newest value of a sensor: its maximum age and its fault."""

from __future__ import annotations

from vehicle.sensors.latest import LatestValue


def test_a_value_is_valid_for_its_maximum_age() -> None:
    latest = LatestValue[int](2.0)
    assert latest.get(0.0) is None
    latest.update(7, 1.0)
    assert latest.get(3.0) == 7
    assert latest.get(3.1) is None


def test_a_fault_lasts_until_the_next_value_and_keeps_the_last() -> None:
    latest = LatestValue[int](2.0)
    latest.update(7, 1.0)
    latest.set_fault(OSError("no\nanswer"))
    assert (latest.fault, latest.get(2.0)) == ("no answer", 7)
    latest.update(8, 2.0)
    assert (latest.fault, latest.get(2.0)) == (None, 8)
