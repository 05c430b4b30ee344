"""Mode numbers and names for our vehicle, ArduPilot and PX4."""

from __future__ import annotations

import pytest

from dialects.enums import Autopilot, ModeFlag, VehicleType, result_name
from dialects.modes import Mode, base_mode, custom_mode, known_modes, mode_name, set_mode_params


def test_numbers_are_ardurovers() -> None:
    # mavutil's mode_mapping_rover: what MAVProxy shows for MAV_TYPE_GROUND_ROVER.
    from pymavlink.mavutil import mode_mapping_rover

    for mode in Mode:
        if mode is not Mode.DOCK:  # newer than pymavlink 2.4.50's table
            assert mode_mapping_rover[mode.value] == mode.name


def test_base_mode_tells_armed_and_manual() -> None:
    assert base_mode(Mode.MANUAL, armed=True) == ModeFlag.CUSTOM | ModeFlag.MANUAL | ModeFlag.ARMED
    assert base_mode(Mode.HOLD, armed=False) == ModeFlag.CUSTOM


@pytest.mark.parametrize(
    ("number", "autopilot", "name"),
    [
        *((0, 0, "MANUAL"), (4, 3, "HOLD"), (99, 3, "mode 99")),
        *((1 << 16, 12, "MANUAL"), (6 << 16, 12, "OFFBOARD"), (9 << 16, 12, "mode 9")),
    ],
)
def test_names(number: int, autopilot: int, name: str) -> None:
    assert mode_name(number, autopilot) == name


def test_do_set_mode_parameters() -> None:
    assert custom_mode(Mode.HOLD, Autopilot.ARDUPILOT) == (4, 0)
    assert custom_mode(Mode.HOLD, Autopilot.PX4) == (4, 3)
    with pytest.raises(ValueError, match="PX4 has no mode CIRCLE"):
        custom_mode(Mode.CIRCLE, Autopilot.PX4)


def test_names_of_results() -> None:
    assert result_name(2) == "denied"
    assert result_name(99) == "result 99"


def test_modes_of_vehicles_that_do_not_list_them() -> None:
    rover = known_modes(Autopilot.ARDUPILOT, VehicleType.GROUND_ROVER)
    assert (rover["MANUAL"], rover["HOLD"], rover["AUTO"], rover["GUIDED"]) == (0, 4, 10, 15)
    assert "INITIALISING" not in rover
    assert known_modes(Autopilot.ARDUPILOT, 2) == {}, "a copter has other numbers"
    px4 = known_modes(Autopilot.PX4, VehicleType.GROUND_ROVER)
    assert (px4["MANUAL"], px4["AUTO_MISSION"]) == (0x010000, 0x04040000)
    assert all(mode_name(custom, Autopilot.PX4) in name for name, custom in px4.items())


def test_parameters_of_do_set_mode() -> None:
    assert set_mode_params(10, Autopilot.ARDUPILOT) == (1, 10, 0)
    assert set_mode_params(0x03040000, Autopilot.PX4) == (1, *custom_mode(Mode.HOLD, Autopilot.PX4))
