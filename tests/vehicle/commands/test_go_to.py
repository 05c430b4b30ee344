"""MISSION_ITEM with current 2 or 3: the go-to of DroneKit, Mission Planner and older scripts."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

from dialects import messages as m
from dialects.enums import Command, MissionResult, MissionType, Result
from dialects.modes import Mode
from tests.vehicle.bench import DRIVER, OTHER, Bench, said
from tests.vehicle.field import GROUND, Field
from tests.vehicle.missions import upload, way
from vehicle.navigation.geo import Point

NAN, INF = math.nan, math.inf
DRIVE_TO, CHANGE_ALTITUDE = 2, 3
PLACE = Point(6.0, 4.0)
INT32_MAX = 2**31 - 1


def guided() -> Field:
    field = Field()
    field.begin(Mode.GUIDED)
    return field


def go(field: Bench, place: Point = PLACE, *, system: int = DRIVER, **changes: Any) -> MissionResult | None:
    """Send the item; return the result of its MISSION_ACK, None for silence."""
    latitude, longitude = GROUND.to_global(place)
    values: dict[str, Any] = {
        "target_system": 1, "target_component": 1, "seq": 0, "frame": 6, "command": Command.NAV_WAYPOINT,
        "current": DRIVE_TO, "autocontinue": 0, "param1": 0.0, "param2": 0.0, "param3": 0.0, "param4": 0.0,
        "x": round(latitude * 1e7), "y": round(longitude * 1e7), "z": 30.0,
    }  # fmt: skip
    before = len(field.all(m.MissionAck))
    field.say(m.MissionItemInt(**(values | changes)), system)
    acks = field.all(m.MissionAck)[before:]
    assert len(acks) <= 1
    if not acks:
        return None
    assert (acks[0].target_system, acks[0].mission_type) == (system, MissionType.MISSION)
    return MissionResult(acks[0].type)


@pytest.mark.parametrize("frame", [0, 3, 5, 6, 10, 11])
def test_in_guided_the_rover_drives_there_and_stops(frame: int) -> None:
    field = guided()
    assert go(field, frame=frame) is MissionResult.ACCEPTED
    field.wait(0.3)
    assert field.turning
    field.until(PLACE, 25.0)
    field.beat(5.0)
    assert field.truth.distance(PLACE) < 0.7
    assert field.stands_for(1.0)


def test_degrees_as_floats_to_all_systems_as_dronekit_sends_them() -> None:
    field = guided()
    latitude, longitude = GROUND.to_global(PLACE)
    field.say(m.MissionItem(0, 0, 0, 3, Command.NAV_WAYPOINT, 2, 0, 0, 0, 0, 0, latitude, longitude, 30.0))
    assert field.newest(m.MissionAck).type == MissionResult.ACCEPTED
    field.until(PLACE, 25.0, radius=1.0)


@pytest.mark.parametrize("changes", [{"z": NAN}, {"param1": NAN, "param2": -1.0, "param4": 720.0}])
def test_altitude_and_parameters_are_not_used(changes: dict[str, Any]) -> None:
    field = guided()
    assert go(field, **changes) is MissionResult.ACCEPTED
    field.wait(0.3)
    assert field.turning


@pytest.mark.parametrize(
    ("changes", "result"),
    [
        ({"x": 0, "y": 0}, MissionResult.INVALID_X),
        ({"x": INT32_MAX}, MissionResult.INVALID_X),
        ({"y": INT32_MAX}, MissionResult.INVALID_X),
        ({"x": 910_000_000}, MissionResult.INVALID_X),
        ({"y": 1_810_000_000}, MissionResult.INVALID_Y),
        ({"z": INF}, MissionResult.INVALID_PARAM7),
        ({"param4": INF}, MissionResult.INVALID_PARAM4),
        ({"frame": 1}, MissionResult.UNSUPPORTED_FRAME),
        ({"frame": 2}, MissionResult.UNSUPPORTED_FRAME),
        ({"frame": 255}, MissionResult.UNSUPPORTED_FRAME),
        ({"command": Command.NAV_LOITER_TIME}, MissionResult.UNSUPPORTED),
        ({"command": Command.CONDITION_YAW}, MissionResult.UNSUPPORTED),
        ({"command": 65535}, MissionResult.UNSUPPORTED),
    ],
)
def test_an_invalid_item_is_refused_and_the_drive_goes_on(changes: dict[str, Any], result: MissionResult) -> None:
    field = guided()
    assert go(field) is MissionResult.ACCEPTED
    assert go(field, Point(-9.0, 0.0), **changes) is result
    field.wait(0.2)
    assert said(field, f"GCS {DRIVER}: go-to refused: ")
    field.until(PLACE, 25.0)


@pytest.mark.parametrize("number", [NAN, INF, 1e30])
def test_a_latitude_that_is_no_number_is_refused(number: float) -> None:
    field = guided()
    field.say(m.MissionItem(1, 1, 0, 3, Command.NAV_WAYPOINT, 2, 0, 0, 0, 0, 0, number, 8.0, 0.0))
    assert field.newest(m.MissionAck).type == MissionResult.INVALID_X
    assert field.stands_for(0.5)


def test_a_place_beyond_100_km_is_refused() -> None:
    field = guided()
    assert go(field, x=0, y=1) is MissionResult.ERROR
    field.wait(0.1)
    assert said(field, "too far away")
    assert field.stands_for(0.5)


def test_outside_of_guided_it_is_refused_and_changes_no_mode() -> None:
    """As in ArduRover; DO_REPOSITION can change the mode."""
    field = Field()
    field.arm()
    assert go(field) is MissionResult.ERROR
    field.wait(0.1)
    assert said(field, "mode is MANUAL, not GUIDED")
    assert field.mode is Mode.MANUAL
    assert field.stands_for(0.5)


def test_disarmed_it_is_refused_and_arming_does_not_revive_it() -> None:
    field = guided()
    field.command(Command.COMPONENT_ARM_DISARM, 0)
    assert go(field) is MissionResult.ERROR
    field.wait(0.1)
    assert said(field, "not armed")
    field.arm()
    assert field.mode is Mode.GUIDED
    assert field.stands_for(1.0)


def test_only_the_driver_may_send_it() -> None:
    field = guided()
    assert go(field) is MissionResult.ACCEPTED
    assert go(field, Point(-9.0, 0.0), system=OTHER) is MissionResult.DENIED
    field.wait(0.1)
    assert said(field, f"GCS {DRIVER} is in control")
    field.until(PLACE, 25.0)


def test_without_anybody_in_control_it_is_denied() -> None:
    field = Field()
    assert field.set_mode(Mode.GUIDED) is Result.ACCEPTED
    assert go(field) is MissionResult.DENIED
    assert field.stands_for(0.5)


def test_an_unknown_sender_and_other_targets_get_no_answer() -> None:
    field = guided()
    assert go(field, target_system=2) is None
    assert go(field, target_component=100) is None
    field.say(m.MissionItemInt(1, 1, 0, 6, 16, 2, 0, 0, 0, 0, 0, 500_000_000, 80_000_000, 0), 77, introduced=False)
    assert field.all(m.MissionAck) == []
    assert field.stands_for(0.5)


def test_without_a_position_it_is_refused() -> None:
    bench = Bench()
    bench.arm()
    bench.set_mode(Mode.GUIDED)
    assert go(bench) is MissionResult.ERROR
    bench.wait(0.1)
    assert said(bench, "position is not known")


def test_a_place_outside_the_fence_is_refused() -> None:
    field = Field(FENCE_ENABLE=1, AVOID_ENABLE=1)
    corners = [(5001, Point(north, east), (4.0,)) for north, east in ((-8, -8), (8, -8), (8, 8), (-8, 8))]
    assert upload(field, *corners, kind=MissionType.FENCE) == MissionResult.ACCEPTED
    field.begin(Mode.GUIDED)
    assert go(field, Point(30.0, 0.0)) is MissionResult.ERROR
    field.wait(0.1)
    assert said(field, "fence")
    assert field.stands_for(0.5)
    assert go(field, PLACE) is MissionResult.ACCEPTED
    field.wait(0.3)
    assert field.turning


@pytest.mark.parametrize(
    "stop",
    [
        lambda field: field.set_mode(Mode.HOLD, OTHER),
        lambda field: field.command(Command.COMPONENT_ARM_DISARM, 0, system=OTHER),
    ],
)
def test_hold_and_disarm_stop_it_like_any_setpoint(stop: Callable[[Field], Result | None]) -> None:
    field = guided()
    assert go(field) is MissionResult.ACCEPTED
    field.wait(1.0)
    assert field.turning
    assert stop(field) is Result.ACCEPTED
    field.wait(1.0)
    assert field.stands_for(1.0)


def test_it_ends_with_its_driver() -> None:
    """GUIDED continues to a position without setpoints, so the ground station failsafe is what stops it."""
    field = guided()
    assert go(field, Point(200.0, 0.0)) is MissionResult.ACCEPTED
    field.wait(4.0)
    assert field.turning
    field.wait(2.5)
    assert field.mode is Mode.HOLD
    assert field.stands_for(1.0)


def test_the_mission_stays_as_it_is() -> None:
    field = guided()
    assert upload(field, way(1.0, 0.0), way(2.0, 0.0)) == MissionResult.ACCEPTED
    assert go(field) is MissionResult.ACCEPTED
    field.say(m.MissionRequestList(1, 1, 0))
    assert field.newest(m.MissionCount).count == 2


def test_a_change_of_altitude_is_unsupported() -> None:
    """Mission Planner sends it without a position."""
    field = guided()
    assert go(field, current=CHANGE_ALTITUDE, x=0, y=0) is MissionResult.UNSUPPORTED
    field.wait(0.1)
    assert said(field, "altitude change refused: a rover has none")
    assert go(field) is MissionResult.ACCEPTED
    assert go(field, current=CHANGE_ALTITUDE) is MissionResult.UNSUPPORTED
    field.until(PLACE, 25.0)


@pytest.mark.parametrize("current", [0, 1, 4, 255])
def test_another_current_is_no_request(current: int) -> None:
    field = guided()
    assert go(field, current=current) is None
    assert field.stands_for(0.5)
