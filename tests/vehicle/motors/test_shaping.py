from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.vehicle.motors.contract import Bench, MotorsContract
from vehicle.motors import MotorSettingsError, open_motors
from vehicle.motors.shaping import Limits, Shape, ShapedMotors, limited, shaped
from vehicle.motors.simulated import SimulatedMotors

throttles = st.floats(-1.0, 1.0)
shares = st.floats(0.0, 1.0)
shapes = (
    st.builds(lambda a, b, r: (min(a, b), max(a, b), r), shares, shares, st.booleans())
    .filter(lambda values: values[0] < values[1])
    .map(lambda values: Shape(minimum=values[0], maximum=values[1], reversed=values[2]))
)


class TestShapedMotors(MotorsContract):
    """As safe as what it shapes: seen from outside the reversed motor turns the other way, and that is all."""

    @pytest.fixture
    def bench(self) -> Bench:
        motors = SimulatedMotors()
        shaped_motors = ShapedMotors(motors, (Shape(), Shape(reversed=True)))
        return Bench(shaped_motors, lambda: (motors.outputs[0], -motors.outputs[1]), lambda: motors.enabled)


@pytest.mark.parametrize(
    ("throttle", "shape", "output"),
    [
        (0.5, Shape(), 0.5),
        (0.5, Shape(reversed=True), -0.5),
        (-0.5, Shape(reversed=True), 0.5),
        (1.0, Shape(maximum=0.9), 0.9),
        (-1.0, Shape(maximum=0.9), -0.9),
        (0.5, Shape(minimum=0.2), 0.6),
        (-0.5, Shape(minimum=0.2), -0.6),
        (0.0, Shape(minimum=0.2), 0.0),
        (1.0, Shape(minimum=0.2, maximum=0.8), 0.8),
    ],
)
def test_shape(throttle: float, shape: Shape, output: float) -> None:
    assert shaped(throttle, shape) == pytest.approx(output)


@given(throttles, shapes)
def test_no_shape_leaves_its_range_or_turns_a_motor_at_rest(throttle: float, shape: Shape) -> None:
    output = shaped(throttle, shape)
    assert abs(output) <= shape.maximum
    assert throttle != 0.0 or output == 0.0
    assert math.copysign(1.0, output) == math.copysign(1.0, throttle) * (-1 if shape.reversed else 1) or not output


@given(throttles, throttles, st.builds(Limits, driving=shares, turning=shares))
def test_limits_only_make_smaller_and_never_turn_round(left: float, right: float, limits: Limits) -> None:
    for before, after in zip((left, right), limited(left, right, limits), strict=True):
        assert abs(after) <= abs(before) * max(limits.driving, limits.turning) + 1e-12
        assert before * after >= 0.0


def test_a_curve_is_between_driving_and_turning() -> None:
    assert limited(1.0, 0.0, Limits(driving=0.6, turning=0.4)) == pytest.approx((0.5, 0.0))


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"shape": [{}]}, "1 shapes for 2 motors"),
        ({"shape": [{"minimum": 0.5, "maximum": 0.5}, {}]}, "shape[0]: minimum 0.5 must be smaller than maximum 0.5"),
        ({"shape": [{"maximum": 1.5}, {}]}, "Expected `float` <= 1"),
        ({"limits": {"drive": 1.0}}, "limits: Object contains unknown field `drive`"),
        ({"speed": 3}, "'simulated' takes no settings, so speed cannot be set"),
        ({"safety": {"estop_pin": 5, "enable_pin": 5}}, "5 is used twice"),
    ],
)
def test_what_goes_around_a_driver_is_read_strictly(settings: dict[str, Any], says: str) -> None:
    with pytest.raises(MotorSettingsError) as caught:
        open_motors("simulated", settings)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_any_driver_can_be_shaped_by_its_settings() -> None:
    motors = open_motors("simulated", {"shape": [{"reversed": True}, {"maximum": 0.5}]})
    assert isinstance(motors, ShapedMotors)
    with pytest.raises(MotorSettingsError, match="limits are for 2 motors"):
        ShapedMotors(SimulatedMotors(4), limits=Limits())
