"""From demand to motor outputs: values that the gate must see, and the limits that are reported."""

from __future__ import annotations

import math

import pytest

from dialects.enums import DriveLimit
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, CYCLE, Bench, said
from vehicle.drive.demand import Demand
from vehicle.drive.drive import Drive
from vehicle.drive.gate import Clearance, Outputs
from vehicle.params import Params

CLEARED = Clearance(armed=True, late=False, held=False, neutral_seen=True, demand_age=0.1, timeout=0.45)


def demand(throttle: float, steering: float = 0.0) -> Demand:
    return Demand(throttle, steering, 0.0, 255, 0)


def run(drive: Drive, wish: Demand | None, cycles: int = 100, *, limited: bool = False, start: float = 0.0) -> Outputs:
    for cycle in range(1, cycles + 1):
        drive.update(wish, CLEARED, limited=limited, now=start + cycle * CYCLE)
    return drive.outputs


@pytest.mark.parametrize("wrong", [demand(math.nan), demand(0.0, math.nan), demand(math.nan, math.nan)])
@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("largest", [100, 50])
def test_nan_becomes_zero_and_not_speed(wrong: Demand, kind: int, largest: float) -> None:
    drive = Drive(Params({"DRIVE_TYPE": kind, "MOT_THR_MAX": largest}), 0.0)
    assert any(run(drive, demand(1.0)).throttles)
    for cycle in range(1, 5):
        outputs = drive.update(wrong, CLEARED, limited=False, now=2.0 + cycle * CYCLE)
        assert outputs == Outputs((0.0,) * len(drive.mixer.motors), enabled=False)
        assert drive.rejected_cycles == cycle
    assert any(run(drive, demand(1.0), start=3.0).throttles)
    assert drive.rejected_cycles == 0


def test_a_nan_sideways_demand_becomes_zero() -> None:
    drive = Drive(Params({"DRIVE_TYPE": 4}), 0.0)
    assert any(run(drive, Demand(0.0, 0.0, 0.0, 255, 0, sideways=1.0)).throttles)
    wrong = Demand(0.0, 0.0, 0.0, 255, 0, sideways=math.nan)
    assert drive.update(wrong, CLEARED, limited=False, now=2.1) == Outputs((0.0,) * 4, enabled=False)


def test_three_cycles_of_nan_are_hold() -> None:
    bench = Bench()
    bench.drive()
    wrong = Demand(math.nan, 0.0, bench.now, 255, 0)
    for _ in range(4):
        bench.rover._control.demand = wrong
        bench.rover._control.neutral_seen = True
        bench.wait(CYCLE)
        assert not bench.turning
    bench.wait(0.2, AHEAD)
    assert bench.mode is Mode.HOLD
    assert said(bench, "Motor values are not numbers: HOLD")


def test_a_limited_throttle_is_reported() -> None:
    drive = Drive(Params({"MOT_THR_MAX": 70}), 0.0)
    found = []
    for start, throttle, limited in ((0.0, 1.0, False), (2.0, 1.0, True), (4.0, 0.3, True)):
        throttles = run(drive, demand(throttle), limited=limited, start=start).throttles
        found.append((round(throttles[0], 2), drive.limits))
    assert found == [(0.7, DriveLimit.SPEED), (0.5, DriveLimit.SPEED), (0.28, DriveLimit(0))]


def test_expo_softens_values_around_neutral() -> None:
    plain, soft = (run(Drive(Params({"MANUAL_EXPO": e}), 0.0), demand(0.3)).throttles[0] for e in (0.0, 0.7))
    assert 0 < soft < plain


def test_a_stop_makes_every_motor_fall_from_the_first_cycle_on() -> None:
    drive = Drive(Params(), 0.0)
    before = run(drive, demand(0.8, -0.6)).throttles
    assert drive.limits == DriveLimit.SATURATED
    after = drive.update(None, CLEARED, limited=False, now=2.0 + CYCLE).throttles
    assert all(abs(new) < abs(old) for new, old in zip(after, before, strict=True))


def test_a_cycle_of_zero_length_changes_nothing() -> None:
    drive = Drive(Params(), 0.0)
    before = run(drive, demand(0.5), cycles=5).throttles
    assert drive.update(demand(1.0), CLEARED, limited=False, now=0.1).throttles == before
    assert drive.update(demand(1.0), CLEARED, limited=False, now=0.05).throttles == before


def test_a_changed_parameter_takes_effect_in_the_next_cycle() -> None:
    params = Params()
    drive = Drive(params, 0.0)
    assert run(drive, demand(1.0)).throttles == (1.0, 1.0)
    params.set("MOT1_MAX", 60)
    assert drive.update(demand(1.0), CLEARED, limited=False, now=2.02).throttles == (0.6, 1.0)
    params.set("MOT_DECEL", 1000)
    assert drive.update(demand(0.0), CLEARED, limited=False, now=2.04).throttles[1] == pytest.approx(0.8)
