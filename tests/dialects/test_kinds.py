"""Kinds of vehicles: which are driven, why the others are not, and the names of their modes."""

from __future__ import annotations

import pytest
from pymavlink import mavutil

from dialects import rover
from dialects.axes import axis_map
from dialects.enums import Autopilot, type_name
from dialects.kinds import find_kind
from dialects.mode_tables import ARDUPILOT, PX4
from tests.rows import each_row

ARDU, PX, OURS = Autopilot.ARDUPILOT, Autopilot.PX4, Autopilot.GENERIC
ROVER, BOAT, COPTER = rover.MAV_TYPE_GROUND_ROVER, rover.MAV_TYPE_SURFACE_BOAT, rover.MAV_TYPE_QUADROTOR
TYPES = [number for name, number in vars(rover).items() if name.startswith("MAV_TYPE_") and name != "MAV_TYPE_ENUM_END"]


MULTICOPTERS = (2, 13, 14, 15, 29, 35, 43)


def test_only_rovers_boats_and_multicopters_are_driven() -> None:
    assert len(TYPES) > 40
    driven = {(kind, autopilot) for kind in TYPES for autopilot in range(21) if find_kind(autopilot, kind).is_driven}
    ground = {(kind, autopilot) for kind in (ROVER, BOAT) for autopilot in (ARDU, PX, OURS)}
    assert driven == ground | {(kind, autopilot) for kind in MULTICOPTERS for autopilot in (ARDU, PX) if kind in TYPES}
    assert not find_kind(OURS, ROVER).flies


@each_row("kind", TYPES, ids=type_name)
@each_row("autopilot", [ARDU, PX, OURS, 5])
def test_every_other_kind_has_one_line_why_and_nothing_to_select(kind: int, autopilot: int) -> None:
    found = find_kind(autopilot, kind)
    if found.is_driven:
        return
    assert 20 < len(found.refusal) < 100
    assert "\n" not in found.refusal
    assert found.choices == {}
    assert not found.keys
    assert all(found.moves_itself(mode) for mode in found.modes.values())


def test_what_flies_falls() -> None:
    falling = {kind for kind in TYPES if find_kind(ARDU, kind).falls}
    assert {COPTER, rover.MAV_TYPE_HELICOPTER, rover.MAV_TYPE_FIXED_WING, rover.MAV_TYPE_GENERIC, 20} <= falling
    assert falling.isdisjoint({ROVER, BOAT, rover.MAV_TYPE_SUBMARINE, rover.MAV_TYPE_ANTENNA_TRACKER})


@each_row("kind", sorted(mavutil.AP_MAV_TYPE_MODE_MAP_DEFAULT))
def test_ardupilots_names_are_pymavlinks(kind: int) -> None:
    theirs = {number: name for number, name in mavutil.AP_MAV_TYPE_MODE_MAP_DEFAULT[kind].items() if name != "LEARNING"}
    assert dict(ARDUPILOT[kind]) == theirs


def test_px4s_numbers_are_pymavlinks() -> None:
    named = {f"{mode[1]}.{mode[2]}" for mode in mavutil.px4_map.values()} - {"4.7"}  # 7 is not used any more
    assert named <= {f"{number >> 16 & 255}.{number >> 24}" for number in PX4}


@each_row(
    ("autopilot", "kind", "number", "name"),
    [
        (OURS, ROVER, 0, "MANUAL"),
        (ARDU, ROVER, 4, "HOLD"),
        (ARDU, COPTER, 4, "GUIDED"),
        (ARDU, COPTER, 9, "LAND"),
        (ARDU, rover.MAV_TYPE_FIXED_WING, 4, "ACRO"),
        (ARDU, rover.MAV_TYPE_SUBMARINE, 19, "MANUAL"),
        (ARDU, ROVER, 99, "mode 99"),
        (OURS, COPTER, 4, "mode 4"),
        (PX, ROVER, 0x00010000, "MANUAL"),
        (PX, ROVER, 0x03040000, "HOLD"),
        (PX, ROVER, 0x04040000, "AUTO_MISSION"),
        (PX, ROVER, 0x05040000, "AUTO_RTL"),
        (PX, ROVER, 0x06040000, "AUTO_LAND"),
        (PX, COPTER, 0x02040000, "AUTO_TAKEOFF"),
        (PX, ROVER, 0x00090000, "mode 589824"),
    ],
)
def test_names_of_modes(autopilot: int, kind: int, number: int, name: str) -> None:
    assert find_kind(autopilot, kind).mode_name(number) == name


def test_numbers_of_modes() -> None:
    assert find_kind(ARDU, ROVER).number_of("hold") == 4
    assert find_kind(PX, ROVER).number_of("HOLD") == 0x03040000
    assert find_kind(PX, ROVER).number_of("auto_loiter") == 0x03040000
    assert find_kind(PX, ROVER).number_of("Position") == 0x00030000
    assert find_kind(PX, ROVER).number_of("CIRCLE") is None
    assert find_kind(ARDU, COPTER).number_of("HOLD") == 17
    assert find_kind(ARDU, 4).number_of("HOLD") is None


def test_what_may_be_selected_without_a_list() -> None:
    rovers = find_kind(ARDU, ROVER).choices
    assert (rovers["MANUAL"], rovers["HOLD"], rovers["AUTO"], rovers["GUIDED"]) == (0, 4, 10, 15)
    assert "INITIALISING" not in rovers
    assert list(find_kind(PX, ROVER).choices) == [
        "MANUAL", "ALTCTL", "POSCTL", "ACRO", "OFFBOARD", "STABILIZED", "HOLD", "AUTO_MISSION", "AUTO_RTL",
    ]  # fmt: skip


def test_px4_moves_itself_in_its_auto_modes_but_hold() -> None:
    rovers = find_kind(PX, ROVER)
    assert not rovers.moves_itself("HOLD")
    assert not rovers.moves_itself("POSCTL")
    assert rovers.moves_itself("AUTO_MISSION")
    assert rovers.moves_itself("OFFBOARD")
    assert rovers.moves_itself("mode 589824")


def test_the_axes_of_a_kind_are_those_of_its_types() -> None:
    for kind in TYPES:
        for autopilot in (ARDU, PX, OURS):
            assert find_kind(autopilot, kind).axes is axis_map(autopilot, kind)


@pytest.mark.parametrize("autopilot", [ARDU, PX])
def test_copters_are_flown_only_where_altitude_is_held(autopilot: int) -> None:
    copter = find_kind(autopilot, COPTER)
    names = set(copter.modes.values())
    assert {copter.drive_mode, copter.land, copter.home, *copter.thrust, *copter.hidden} <= names
    assert copter.drive_mode in copter.keys
    assert not copter.keys & copter.thrust
    assert not set(copter.choices) & copter.thrust
    assert copter.mode_name(copter.number_of("MANUAL") or 0) == copter.drive_mode
    assert copter.number_of("LAND") is not None
    assert copter.number_of("RTL") is not None
    assert copter.mode_name(copter.number_of("HOLD") or 0) in copter.standing
    assert not any(map(copter.takes_neutral, (*copter.thrust, "mode 99")))
    assert all(map(copter.takes_neutral, copter.keys))
    assert copter.axes.climb_neutral == 500
