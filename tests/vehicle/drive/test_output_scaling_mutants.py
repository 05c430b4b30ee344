"""Output scaling: its defaults, percentages, and the ends of the thrust curve."""

from __future__ import annotations

import pytest

from vehicle.drive.output_scaling import PARAM_NAMES, OutputScaling, build_output_scaling, linearize_thrust
from vehicle.params import MOTORS, PARAMETERS, Params


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
def test_the_ends_of_the_curve(curve: float) -> None:
    assert linearize_thrust(0.0, curve) == 0.0
    assert linearize_thrust(1.0, curve) == pytest.approx(1.0)
    assert linearize_thrust(1.0, curve) <= 1.0
