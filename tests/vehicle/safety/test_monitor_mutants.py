"""DISARM_DELAY: from when the time without a demand is counted."""

from __future__ import annotations

from dialects.enums import Result
from tests.vehicle.bench import NEUTRAL, Bench, said


def test_the_delay_begins_with_the_arming_not_with_the_start_of_the_vehicle() -> None:
    bench = Bench(DISARM_DELAY=20)
    bench.wait(60.0)
    assert bench.arm() is Result.ACCEPTED
    bench.wait(19.0, NEUTRAL, period=0.2)
    assert bench.armed
    bench.wait(2.0, NEUTRAL, period=0.2)
    assert not bench.armed
    assert said(bench, "Disarmed: no demand for 20 s")
