"""What is read beside a driver's own settings."""

from __future__ import annotations

from typing import Any

import pytest

from vehicle.motors import DRIVERS, PROFILE_PARAMS, MotorSettingsError, open_motors, safe_stop
from vehicle.motors.simulated import SimulatedMotors
from vehicle.params import Params


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"speed": 3}, "'simulated' takes no settings, so speed cannot be set"),
        ({"safety": {"estop_pin": 5, "enable_pin": 5}}, "5 is used twice"),
        ({"safety": {"estop": 5}}, "safety: Object contains unknown field `estop`"),
    ],
)
def test_what_goes_around_a_driver_is_read_strictly(settings: dict[str, Any], says: str) -> None:
    with pytest.raises(MotorSettingsError) as caught:
        open_motors("simulated", settings)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_file_of_before_stops_the_motors() -> None:
    """The daemon refuses such a file; safe-stop must not."""
    old = {"shape": [{"reversed": True}, {}], "limits": {"driving": 0.6}}
    assert safe_stop("simulated", old) == []
    assert isinstance(open_motors("simulated", old), SimulatedMotors)


@pytest.mark.parametrize("name", PROFILE_PARAMS)
def test_a_known_car_has_parameters_that_there_are(name: str) -> None:
    assert name in DRIVERS
    assert Params(PROFILE_PARAMS[name])
