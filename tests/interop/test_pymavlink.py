"""pymavlink's mavutil, as scripts use it: wait for a vehicle, select a mode, arm, drive, read parameters and files."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from dialects.enums import MissionResult
from tests.e2e.programs import Vehicle
from tests.interop.conftest import HOME, Rover
from tests.interop.script import Script, mavftp, mavparm, mavutil, mavwp
from tests.ports import free_port
from vehicle.params import TABLE

pytestmark = pytest.mark.interop

WAYPOINT, GLOBAL_RELATIVE_ALT = 16, 3
"""MAV_CMD, MAV_FRAME"""
ROVER_MODES = {"HOLD": 4, "MANUAL": 0}


@pytest.fixture
def script(rover: Rover) -> Iterator[Script]:
    """Return mavutil with its default ids, connected, after it has sent its HEARTBEAT."""
    with Script(rover.port, 255, 0) as script:
        yield script


def test_modes_have_their_names_and_the_stick_drives(script: Script, rover: Rover) -> None:
    link = script.link
    for mode, number in ROVER_MODES.items():
        assert link.mode_mapping()[mode] == number
        link.set_mode(mode)
        script.until(lambda wanted=mode: link.flightmode == wanted)  # type: ignore[misc]
    link.arducopter_arm()
    script.until(link.motors_armed)
    script.drive(500, rover.vehicle.turning)
    rover.stands()  # because no demand arrives any more
    link.arducopter_disarm()
    script.until(lambda: not link.motors_armed())


@pytest.mark.parametrize("as_int", [False, True])
def test_a_mission_item_with_current_2_drives_in_guided_only(script: Script, rover: Rover, as_int: bool) -> None:
    """As in scripts made for ArduPilot; DroneKit's simple_goto sends the floats, to system and component 0."""
    link, place = script.link, (HOME[0] + 0.00004, HOME[1])

    def item(current: int) -> int | None:
        if as_int:
            x, y = round(place[0] * 1e7), round(place[1] * 1e7)
            link.mav.mission_item_int_send(1, 1, 0, GLOBAL_RELATIVE_ALT, WAYPOINT, current, 0, 0, 0, 0, 0, x, y, 0)
        else:
            link.mav.mission_item_send(0, 0, 0, GLOBAL_RELATIVE_ALT, WAYPOINT, current, 0, 0, 0, 0, 0, *place, 0)
        ack = script.hear("MISSION_ACK", within=1.0)
        return None if ack is None else int(ack.type)

    script.until(lambda: "GLOBAL_POSITION_INT" in link.messages)
    link.set_mode("MANUAL")
    script.until(lambda: link.flightmode == "MANUAL")
    link.arducopter_arm()
    script.until(link.motors_armed)
    assert item(2) == MissionResult.ERROR
    assert not rover.vehicle.turning()
    link.set_mode("GUIDED")
    script.until(lambda: link.flightmode == "GUIDED")
    script.insist(lambda: None, lambda: item(2) == MissionResult.ACCEPTED)
    script.until(rover.vehicle.turning)
    assert item(3) == MissionResult.UNSUPPORTED
    script.until(lambda: rover.is_near(place))
    script.until(rover.vehicle.stands)


def test_parameters_and_files(script: Script) -> None:
    link = script.link
    link.param_fetch_all()
    script.until(lambda: len(link.params) == len(TABLE))
    assert link.params["SPEED_MAX"] == 1.5
    assert mavparm.MAVParmDict().mavset(link, "SPEED_MAX", 1.25, retries=3)
    link.param_fetch_one("SPEED_MAX")
    script.until(lambda: link.params["SPEED_MAX"] == 1.25)
    names = [entry.name for entry in mavftp.MAVFTP(link, 1, 1).cmd_list(["/"]).directory_listing]
    assert names == ["@PARAM", "logs", "missions", "general.json.xz", "parameter.json.xz"]
    values = mavftp.MAVFTP.ftp_param_decode(script.fetch("@PARAM/param.pck?withdefaults=1"))
    assert len(values.params) == len(TABLE)


def test_a_mission_of_100_items_goes_up_and_comes_back(script: Script) -> None:
    loader = mavwp.MAVWPLoader(target_system=1, target_component=1)
    for number in range(100):
        loader.add_latlonalt(47.0 + number / 1e5, 8.0, 0)
    assert script.upload(loader) == MissionResult.ACCEPTED
    items = script.download()
    assert [item.seq for item in items] == list(range(100))
    for number, item in enumerate(items):
        assert item.x / 1e7 == pytest.approx(47.0 + number / 1e5, abs=4e-6)  # mavwp sends float32 degrees
    script.link.waypoint_clear_all_send()
    assert script.hear("MISSION_ACK").type == MissionResult.ACCEPTED


def test_over_tcp_the_vehicle_speaks_first(tmp_path: Path) -> None:
    """mavutil sends no HEARTBEAT of its own, and scripts wait for the vehicle's."""
    port = free_port()
    with ExitStack() as stack:
        stack.callback(Vehicle(tmp_path, f"tcpin:127.0.0.1:{port}").end)
        link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{port}", retries=60)
        stack.callback(link.close)
        assert link.wait_heartbeat(timeout=15) is not None
        link.param_fetch_all()
        while len(link.params) < len(TABLE):
            assert link.recv_match(type="PARAM_VALUE", blocking=True, timeout=10) is not None
