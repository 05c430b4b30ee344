"""Speed and turn-rate control: feed-forward without sensors, correction with them, limits of ramps and integrals."""

from __future__ import annotations

import pytest

from dialects.enums import DriveType
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.speed_control import STATIONARY, DesiredMotion, SpeedTurnController
from vehicle.params import Params

BLIND = Estimate()


def settled(controller: SpeedTurnController, wanted: DesiredMotion, estimate: Estimate) -> tuple[float, float]:
    """Throttle and steering after 20 s."""
    for cycle in range(1000):
        result = controller.step(wanted, estimate, cycle * 0.02)
    return result


def test_without_sensors_the_feed_forward_drives() -> None:
    params = Params({"CRUISE_SPEED": 1.0, "CRUISE_THROTTLE": 50, "ATC_STR_RAT_FF": 0.2})
    throttle, steering = settled(SpeedTurnController(params, DriveType.SKID), DesiredMotion(0.8, 1.0), BLIND)
    assert throttle == pytest.approx(0.4)
    assert steering == pytest.approx(0.2)


def test_the_speed_rises_and_falls_by_its_ramps() -> None:
    params = Params({"CRUISE_SPEED": 1.0, "CRUISE_THROTTLE": 50, "ATC_ACCEL_MAX": 1.0, "ATC_DECEL_MAX": 2.0})
    controller = SpeedTurnController(params, DriveType.SKID)
    controller.step(STATIONARY, BLIND, 0.0)
    assert controller.step(DesiredMotion(1.0, 0.0), BLIND, 0.1)[0] == pytest.approx(0.05)
    settled(controller, DesiredMotion(1.0, 0.0), BLIND)
    controller.step(DesiredMotion(1.0, 0.0), BLIND, 30.0)
    assert controller.step(STATIONARY, BLIND, 30.1)[0] == pytest.approx(0.4)


def test_a_rover_that_is_held_gets_full_throttle_and_no_more() -> None:
    controller = SpeedTurnController(Params({"ATC_SPEED_I": 1.0}), DriveType.SKID)
    throttle, _ = settled(controller, DesiredMotion(1.0, 0.0), Estimate(yaw=0.0, yaw_rate=0.0, speed=0.0))
    assert throttle == 1.0
    controller.reset()
    assert controller.step(STATIONARY, Estimate(speed=0.0), 100.0) == (0.0, 0.0)


@pytest.mark.parametrize("speed", [0.5, -0.5])
def test_a_car_steers_the_other_way_when_it_backs_up(speed: float) -> None:
    controller = SpeedTurnController(Params(), DriveType.ACKERMANN)
    steering = controller.steering_for_rate(0.3, Estimate(speed=speed), 1.0)
    assert steering * speed > 0.0
