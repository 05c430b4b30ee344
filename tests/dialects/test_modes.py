"""Mode numbers and names for our vehicle, ArduPilot and PX4."""

from __future__ import annotations

import math

import pytest

from dialects.enums import Autopilot, ModeFlag, result_name
from dialects.modes import Mode, base_mode, custom_mode_of, set_mode_params


def test_numbers_are_ardurovers() -> None:
    # mavutil's mode_mapping_rover: what MAVProxy shows for MAV_TYPE_GROUND_ROVER.
    from pymavlink.mavutil import mode_mapping_rover

    for mode in Mode:
        if mode is not Mode.DOCK:  # newer than pymavlink 2.4.50's table
            assert mode_mapping_rover[mode.value] == mode.name


def test_base_mode_tells_armed_and_manual() -> None:
    assert base_mode(Mode.MANUAL, armed=True) == ModeFlag.CUSTOM | ModeFlag.MANUAL | ModeFlag.ARMED
    assert base_mode(Mode.HOLD, armed=False) == ModeFlag.CUSTOM


def test_names_of_results() -> None:
    assert result_name(2) == "denied"
    assert result_name(99) == "result 99"


def test_parameters_of_do_set_mode() -> None:
    assert set_mode_params(10, Autopilot.ARDUPILOT) == (1, 10, 0)
    assert set_mode_params(0x03040000, Autopilot.PX4) == (1, 4, 3)


@pytest.mark.parametrize(
    ("params", "autopilot", "number"),
    [
        ((1, 10, 0), Autopilot.ARDUPILOT, 10),
        ((1, 4, 3), Autopilot.PX4, 0x03040000),
        ((1, 4, math.nan), Autopilot.ARDUPILOT, 4),
        ((0, 4, 0), Autopilot.ARDUPILOT, None),
        ((1, math.nan, 0), Autopilot.ARDUPILOT, None),
        ((1, -1, 0), Autopilot.ARDUPILOT, None),
        ((1, 4.5, 0), Autopilot.ARDUPILOT, None),
    ],
)
def test_the_mode_that_do_set_mode_names(params: tuple[float, float, float], autopilot: int, number: int) -> None:
    assert custom_mode_of(*params, autopilot) == number
