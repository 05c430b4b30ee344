"""What is read beside a driver's own settings."""

from __future__ import annotations

from typing import Any

import pytest

from vehicle.motors import MotorSettingsError
from vehicle.motors.drivers import DRIVERS, open_motors, profile_params
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


@pytest.mark.parametrize("name", [name for name, entry in DRIVERS.items() if entry.profile])
def test_a_known_car_has_parameters_that_exist(name: str) -> None:
    assert DRIVERS[name].params
    assert Params(profile_params(name))
