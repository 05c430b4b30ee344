"""What is a hazard, and since when: to the degree, the throttle and the moment."""

from __future__ import annotations

import math

import pytest

from dialects.enums import Failsafe
from vehicle.navigation.estimate import Estimate
from vehicle.params import Params
from vehicle.readings import Readings
from vehicle.safety.hazards import BLOCKED_SPEED_MAX, BLOCKED_THROTTLE_MIN, HazardInputs, HazardMonitor

SAFE = HazardInputs(Readings(), Estimate(good=True), (0.0, 0.0), needs_position=False, guided_lost=None, outside=False)
PARAMS = Params({"CRASH_ANGLE": 45})
LARGEST = math.radians(45)


def found(look: HazardInputs, params: Params = PARAMS) -> Failsafe:
    return Failsafe(sum(HazardMonitor(params).update(look, 1.0)))


def test_nothing_is_a_hazard_at_rest() -> None:
    assert HazardMonitor(PARAMS).update(SAFE, 1.0) == {}
    assert HazardMonitor(PARAMS).update(SAFE._replace(needs_position=True), 1.0) == {}


def test_each_hazard_is_told_with_its_begin_and_for_as_long_as_it_lasts() -> None:
    lost = SAFE._replace(estimate=Estimate(), needs_position=True)
    monitor = HazardMonitor(PARAMS)
    assert monitor.update(lost, 1.0) == {Failsafe.POSITION: 1.0}
    assert monitor.update(lost._replace(outside=True), 2.0) == {Failsafe.POSITION: 1.0, Failsafe.FENCE: 2.0}
    assert monitor.update(SAFE._replace(outside=True), 3.0) == {Failsafe.FENCE: 2.0}
    assert monitor.update(SAFE, 4.0) == {}
    assert monitor.update(lost, 5.0) == {Failsafe.POSITION: 5.0}


def test_a_position_that_nobody_needs_is_no_hazard() -> None:
    assert found(SAFE._replace(estimate=Estimate())) == 0


def test_setpoints_are_lost_after_the_moment_they_are_said_to_be() -> None:
    monitor = HazardMonitor(PARAMS)
    look = SAFE._replace(guided_lost=2.0, outside=True)
    assert monitor.update(look, 2.0) == {Failsafe.FENCE: 2.0}
    assert monitor.update(look, 2.1) == {Failsafe.FENCE: 2.0, Failsafe.GUIDED_LOSS: 2.0}
    assert monitor.update(SAFE, 2.2) == {}


@pytest.mark.parametrize("angle", ["roll", "pitch"])
@pytest.mark.parametrize("sign", [1, -1])
def test_tilted_beyond_the_angle_either_way(angle: str, sign: int) -> None:
    def tilted(value: float, params: Params = PARAMS) -> bool:
        return found(SAFE._replace(readings=Readings(**{angle: sign * value})), params) == Failsafe.TILT  # type: ignore[arg-type]

    assert not tilted(LARGEST)
    assert tilted(LARGEST + 0.001)
    assert tilted(0.3, Params({"CRASH_ANGLE": 10}))
    assert not tilted(3.0, Params({"CRASH_ANGLE": 0}))


@pytest.mark.parametrize("wheels", [(0.04, -0.04), (0.0, 0.049)])
def test_blocked_is_throttle_without_a_wheel_that_turns(wheels: tuple[float, ...]) -> None:
    assert (BLOCKED_THROTTLE_MIN, BLOCKED_SPEED_MAX) == (0.2, 0.05)
    still = Readings(wheel_speeds=wheels)
    for throttles in ((0.2, 0.0), (0.0, -0.2), (1.0, 1.0)):
        assert found(SAFE._replace(readings=still, throttles=throttles)) == Failsafe.BLOCKED
    assert found(SAFE._replace(readings=still, throttles=(0.19, -0.19))) == 0
    for turning in ((0.05, 0.0), (0.0, -0.05)):
        assert found(SAFE._replace(readings=Readings(wheel_speeds=turning), throttles=(1.0, 1.0))) == 0


def test_blocked_without_wheel_speeds_goes_by_the_estimate() -> None:
    full = SAFE._replace(throttles=(1.0, 1.0))
    assert found(full) == 0  # no speed is known
    assert found(full._replace(estimate=Estimate(speed=0.04))) == Failsafe.BLOCKED
    assert found(full._replace(estimate=Estimate(speed=-0.05))) == 0
    assert found(full._replace(estimate=Estimate(speed=0.0, sideways=0.1))) == 0
