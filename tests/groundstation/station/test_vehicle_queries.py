"""Queries that the station sends on its own, and when it sends none."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Autopilot, Command
from groundstation.vehicles.stream_requests import CAPACITY_SHARE, LOAD
from tests.groundstation.fake_ardupilot import FakeArduPilot
from tests.groundstation.fake_vehicle import Cockpit, FakeVehicle

INTERVAL = Command.SET_MESSAGE_INTERVAL


def requested_rates(vehicle: FakeVehicle) -> dict[int, float]:
    """Message -> rate in Hz, as requested."""
    return {int(each.param1): 1e6 / each.param2 for each in vehicle.commands(INTERVAL)}


def test_no_queries_while_the_link_is_lost() -> None:
    vehicle = FakeArduPilot()
    vehicle.silent_on.add(INTERVAL)
    cockpit = Cockpit(vehicle)
    cockpit.run(1.0)
    cockpit.world.cut()
    cockpit.run(3.0)
    assert not cockpit.view.alive
    lost = cockpit.now
    cockpit.run(10.0)
    asked = (m.RequestDataStream, m.ParamRequestRead, m.CommandLong)
    assert [message for at, message in cockpit.world.near.sent if at > lost and isinstance(message, asked)] == []


def test_no_queries_while_the_screen_is_frozen() -> None:
    vehicle = FakeArduPilot()
    vehicle.silent_on.add(INTERVAL)
    cockpit = Cockpit(vehicle)
    cockpit.leasing = False
    cockpit.run(5.0)
    assert len(vehicle.all(m.RequestDataStream)) == 0


def test_the_capacity_is_that_of_the_vehicles_link() -> None:
    vehicle = FakeArduPilot()
    cockpit = Cockpit(vehicle)
    cockpit.world.near.channel._capacity = 960.0
    cockpit.run(2.0)
    assert requested_rates(vehicle)[m.Attitude.id] == pytest.approx(10 * CAPACITY_SHARE * 960 / LOAD, rel=0.01)


def test_ardupilot_settings_that_let_it_drive_on_are_warned_of() -> None:
    vehicle = FakeVehicle(autopilot=Autopilot.ARDUPILOT, driver=None)
    vehicle.parameters = {"RC_OVERRIDE_TIME": 3.0, "FS_GCS_ENABLE": 0.0, "FS_THR_ENABLE": 1.0, "MAV_GCS_SYSID": 255.0}
    cockpit = Cockpit(vehicle)
    cockpit.run(3.0)
    assert cockpit.view.warnings == (
        "RC_OVERRIDE_TIME 3: drives on for 3 s when the link is lost",
        "FS_GCS_ENABLE 0: no failsafe when the ground station is lost",
    )
