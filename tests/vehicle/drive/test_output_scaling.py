"""Output scaling: the motor value for a wheel value, the defaults, and the thrust curve."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.rows import each_row
from vehicle.drive.mixer import MIXERS
from vehicle.drive.output_scaling import (
    PARAM_NAMES,
    OutputScaling,
    build_output_scaling,
    linearize_thrust,
    scale_outputs,
)
from vehicle.params import MOTORS, PARAMETERS, Params

UNIT = st.floats(-1.0, 1.0)


@st.composite
def fits(draw: st.DrawFn) -> OutputScaling:
    """All that the parameters can say."""
    ranges = [PARAMETERS[name] for name in PARAM_NAMES[0]]
    _, smallest, largest, trim = (draw(st.floats(each.low, each.high)) for each in ranges)
    low = min(smallest, largest - 0.01)
    return OutputScaling(draw(st.booleans()), low / 100, largest / 100, trim / 100, draw(st.floats(-1, 1)))


@each_row(
    ("fit", "throttle", "output"),
    [
        (OutputScaling(), 0.5, 0.5),
        (OutputScaling(), -1.0, -1.0),
        (OutputScaling(reversed=True), 0.5, -0.5),
        (OutputScaling(reversed=True), -0.5, 0.5),
        (OutputScaling(largest=0.9), 1.0, 0.9),
        (OutputScaling(largest=0.9), -1.0, -0.9),
        (OutputScaling(smallest=0.2), 0.5, 0.6),
        (OutputScaling(smallest=0.2), -0.5, -0.6),
        (OutputScaling(smallest=0.2), 1e-9, 0.2),
        (OutputScaling(smallest=0.2), 0.0, 0.0),
        (OutputScaling(smallest=0.2, largest=0.8), 1.0, 0.8),
        (OutputScaling(trim=0.1), 0.5, 0.6),
        (OutputScaling(trim=0.1), -0.5, -0.4),
        (OutputScaling(trim=0.1), 0.0, 0.0),
        (OutputScaling(trim=0.1), -0.05, 0.0),  # not round
        (OutputScaling(trim=0.1), 1.0, 1.0),  # not beyond full
        (OutputScaling(trim=0.1, largest=0.8), 1.0, 0.8),
        (OutputScaling(trim=0.1, reversed=True), 0.5, -0.4),
        (OutputScaling(curve=1.0), 0.25, 0.5),
        (OutputScaling(curve=1.0, smallest=0.2, reversed=True), 0.25, -0.6),
    ],
)
def test_a_driven_motor(fit: OutputScaling, throttle: float, output: float) -> None:
    assert fit.scale_throttle(throttle) == pytest.approx(output)


@each_row(
    ("fit", "steering", "output"),
    [
        (OutputScaling(), 0.5, 0.5),
        (OutputScaling(reversed=True), 1.0, -1.0),
        (OutputScaling(trim=0.1), 0.0, 0.1),
        (
            OutputScaling(trim=0.1, reversed=True),
            0.0,
            0.1,
        ),  # wheels that point ahead still do when the servo is reversed
        (OutputScaling(trim=0.1), 1.0, 1.0),
        (OutputScaling(trim=0.1), -1.0, -1.0),
        (OutputScaling(trim=0.1), 0.5, 0.55),
        (OutputScaling(trim=-0.2, largest=0.6), -0.5, -0.4),
        (OutputScaling(smallest=0.5), 0.01, 0.01),  # a step at its centre would make it flutter
        (OutputScaling(curve=1.0), 0.25, 0.25),
    ],
)
def test_a_steering_servo(fit: OutputScaling, steering: float, output: float) -> None:
    assert fit.scale_steering(steering) == pytest.approx(output)


@given(fits(), UNIT)
def test_scaling_neither_starts_nor_reverses_nor_leaves_range(fit: OutputScaling, throttle: float) -> None:
    output = fit.scale_throttle(throttle)
    assert abs(output) <= fit.largest
    assert throttle or output == 0.0
    assert output * throttle * (-1 if fit.reversed else 1) >= 0.0


@given(fits(), st.tuples(UNIT, UNIT).map(sorted))
def test_output_rises_monotonically_with_throttle(fit: OutputScaling, throttles: list[float]) -> None:
    """So that a wheel that falls has a motor that falls."""
    less, more = ((-1 if fit.reversed else 1) * fit.scale_throttle(throttle) for throttle in throttles)
    assert less <= more + 1e-9
    less, more = ((-1 if fit.reversed else 1) * fit.scale_steering(steering) for steering in throttles)
    assert less <= more + 1e-9


@given(fits(), UNIT)
def test_a_servo_stays_within_its_limits(fit: OutputScaling, steering: float) -> None:
    assert abs(fit.scale_steering(steering)) <= fit.largest
    assert fit.scale_steering(1.0) == pytest.approx(fit.largest * (-1 if fit.reversed else 1))


@given(st.floats(0.01, 1.0), st.floats(-1.0, 1.0).filter(lambda curve: abs(curve) > 1e-3))
def test_the_thrust_curve_matches_ardurover(throttle: float, curve: float) -> None:
    theirs = (curve - 1 + math.sqrt(max(0, (1 - curve) ** 2 + 4 * curve * throttle))) / (2 * curve)
    assert linearize_thrust(throttle, curve) == pytest.approx(theirs, abs=1e-6)
    assert linearize_thrust(1.0, curve) == pytest.approx(1.0)
    assert linearize_thrust(0.0, curve) == 0.0


def test_each_motor_has_its_own_scaling() -> None:
    params = Params({"MOT1_REVERSED": 1, "MOT2_MIN": 20, "MOT3_MAX": 50, "MOT4_TRIM": -10})
    assert scale_outputs((0.5,) * 4, 4, build_output_scaling(params)) == pytest.approx((-0.5, 0.6, 0.25, 0.4))
    params = Params({"MOT1_TRIM": 10, "MOT2_TRIM": 10, "MOT2_MIN": 50})
    assert scale_outputs((0.0, 0.0), 1, build_output_scaling(params)) == pytest.approx((0.0, 0.1))


def test_there_are_parameters_for_every_motor() -> None:
    assert max(len(mixer.motors) for mixer in MIXERS.values()) == MOTORS


def test_what_is_not_set_changes_nothing() -> None:
    assert OutputScaling() == (False, 0.0, 1.0, 0.0, 0.0)
    assert build_output_scaling(Params()) == [OutputScaling()] * MOTORS


def test_parameters_are_percent() -> None:
    params = Params({"MOT2_REVERSED": 1, "MOT2_MIN": 10, "MOT2_MAX": 50, "MOT2_TRIM": -5, "MOT_THST_EXPO": 0.25})
    assert build_output_scaling(params)[1] == (True, 0.1, 0.5, -0.05, 0.25)


def test_every_motor_has_its_parameters() -> None:
    assert [names[0] for names in PARAM_NAMES] == [f"MOT{number}_REVERSED" for number in range(1, MOTORS + 1)]
    assert all(name in PARAMETERS for names in PARAM_NAMES for name in names)


@pytest.mark.parametrize("curve", [-1.0, -0.99, -0.5, 0.0, 0.34, 0.5, 1.0])
def test_ends_of_the_curve_and_nan(curve: float) -> None:
    assert linearize_thrust(0.0, curve) == 0.0
    assert math.isnan(linearize_thrust(math.nan, curve))
    assert linearize_thrust(1.0, curve) == pytest.approx(1.0)
    assert linearize_thrust(1.0, curve) <= 1.0
