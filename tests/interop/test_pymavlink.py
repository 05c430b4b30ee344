"""pymavlink's mavutil, as scripts use it: wait for a vehicle, choose a mode, arm, drive, read parameters and files."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any

import pytest

from tests.interop.conftest import Rover
from vehicle.params import TABLE

pytestmark = pytest.mark.interop

mavftp: Any = import_module("pymavlink.mavftp")  # half typed: none of it is checked
mavparm: Any = import_module("pymavlink.mavparm")
mavwp: Any = import_module("pymavlink.mavwp")
mavutil: Any = import_module("pymavlink.mavutil")

ROVER_MODES = {"MANUAL": 0, "HOLD": 4}
ACK = "MISSION_ACK"
GCS, NO_AUTOPILOT, ACTIVE = 6, 8, 4


@pytest.fixture
def connection(rover: Rover, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """mavutil, connected, with its own HEARTBEAT said."""
    monkeypatch.setenv("MAVLINK20", "1")
    mavutil.set_dialect("common")
    connection = mavutil.mavlink_connection(f"udpin:127.0.0.1:{rover.port}", source_system=255, source_component=190)
    assert connection.wait_heartbeat(timeout=15) is not None
    connection.mav.heartbeat_send(GCS, NO_AUTOPILOT, 0, 0, ACTIVE)
    yield connection
    connection.close()


def until(connection: Any, condition: Callable[[], bool], within: float = 5.0) -> None:
    """Receive until `condition`, and say a HEARTBEAT each second."""
    deadline = time.monotonic() + within
    while not condition():
        assert time.monotonic() < deadline
        connection.recv_match(blocking=True, timeout=0.1)
        connection.mav.heartbeat_send(GCS, NO_AUTOPILOT, 0, 0, ACTIVE)


@pytest.mark.parametrize("mode", ["HOLD", "MANUAL"])
def test_modes_have_their_names(connection: Any, mode: str) -> None:
    assert connection.mode_mapping()[mode] == ROVER_MODES[mode]
    connection.set_mode("HOLD")
    until(connection, lambda: connection.flightmode == "HOLD")
    connection.set_mode(mode)
    until(connection, lambda: connection.flightmode == mode)


def test_it_arms_and_drives(connection: Any, rover: Rover) -> None:
    connection.arducopter_arm()
    until(connection, connection.motors_armed)
    for throttle in (0, 500):
        begun = time.monotonic()
        while not rover.vehicle.turning() and time.monotonic() < begun + (5 if throttle else 0.3):
            connection.mav.manual_control_send(1, throttle, 0, 0, 0, 0)
            connection.recv_match(blocking=True, timeout=0.05)
    assert rover.vehicle.turning()
    rover.stands()  # because nothing comes any more
    connection.arducopter_disarm()
    until(connection, lambda: not connection.motors_armed())


def test_parameters(connection: Any) -> None:
    connection.param_fetch_all()
    until(connection, lambda: len(connection.params) == len(TABLE))
    assert connection.params["SPEED_MAX"] == 1.5
    table = mavparm.MAVParmDict()
    assert table.mavset(connection, "SPEED_MAX", 1.25, retries=3)
    connection.param_fetch_one("SPEED_MAX")
    until(connection, lambda: connection.params["SPEED_MAX"] == 1.25)


def test_a_mission_of_100_items_goes_up_and_comes_back(connection: Any) -> None:
    loader = mavwp.MAVWPLoader(target_system=1, target_component=1)
    for number in range(100):
        loader.add_latlonalt(47.0 + number / 1e5, 8.0, 0)
    connection.waypoint_count_send(loader.count())
    while (asked := answer(connection, "MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK")).get_type() != ACK:
        connection.mav.send(loader.wp(asked.seq))
    assert asked.type == 0
    connection.waypoint_request_list_send()
    assert answer(connection, "MISSION_COUNT").count == 100
    for number in range(100):
        connection.mav.mission_request_int_send(1, 1, number)
        item = answer(connection, "MISSION_ITEM_INT")
        assert item.seq == number
        assert item.x / 1e7 == pytest.approx(47.0 + number / 1e5, abs=4e-6)  # mavwp sends float32 degrees
    connection.waypoint_clear_all_send()
    assert answer(connection, ACK).type == 0


def answer(connection: Any, *types: str) -> Any:
    """The next message of these types."""
    message = connection.recv_match(type=list(types), blocking=True, timeout=5)
    assert message is not None, types
    return message


def test_files(connection: Any) -> None:
    ftp = mavftp.MAVFTP(connection, 1, 1)
    names = [entry.name for entry in ftp.cmd_list(["/"]).directory_listing]
    assert names == ["@PARAM", "logs", "missions", "general.json.xz", "parameter.json.xz"]
    came: list[bytes] = []
    ftp.cmd_get(["@PARAM/param.pck?withdefaults=1"], callback=lambda file: came.append(file.read() if file else b""))
    ftp.process_ftp_reply("OpenFileRO", timeout=10)
    values = mavftp.MAVFTP.ftp_param_decode(came[0])
    assert len(values.params) == len(TABLE)
