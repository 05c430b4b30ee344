"""Queries that the station sends on its own, and when it sends none."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Autopilot, Command
from groundstation.vehicles.probes.stream_requests import CAPACITY_SHARE, LOAD
from groundstation.views.log import LogRequest
from link.core import Peer, Received
from tests.fakes.rover import FakeArduPilot
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import Cockpit

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


def homes(vehicle: FakeVehicle) -> int:
    return sum(each.param1 == m.HomePosition.id for each in vehicle.commands(Command.REQUEST_MESSAGE))


def test_home_is_requested_until_it_is_known() -> None:
    vehicle = FakeArduPilot()
    cockpit = Cockpit(vehicle)
    cockpit.run(4.0)
    assert homes(vehicle) == 1
    vehicle.send(m.HomePosition(-353632620, 1491652370, 584000, 0, 0, 0, [1, 0, 0, 0], 0, 0, 0))
    cockpit.run(30.0)
    assert homes(vehicle) == 1
    contact = cockpit.station.fleet.get(1)
    assert contact is not None
    assert contact.details.home is not None


def test_home_is_requested_a_few_times_and_again_after_a_reboot() -> None:
    vehicle = FakeArduPilot()
    cockpit = Cockpit(vehicle)
    cockpit.run(60.0)
    assert homes(vehicle) == 3
    vehicle.send(m.SystemTime(0, 600_000))
    cockpit.run(1.0)
    vehicle.send(m.SystemTime(0, 1_000))
    cockpit.run(5.0)
    assert homes(vehicle) == 4


def test_home_of_our_own_rover_is_not_requested() -> None:
    vehicle = FakeVehicle()
    cockpit = Cockpit(vehicle)
    cockpit.run(10.0)
    assert homes(vehicle) == 0


def test_a_breach_is_requested_shown_and_logged() -> None:
    vehicle = FakeArduPilot()
    cockpit = Cockpit(vehicle)
    cockpit.run(4.0)
    assert m.FenceStatus.id in requested_rates(vehicle)
    vehicle.send(m.FenceStatus(1, 1, 3, 104172, 1))
    cockpit.run(0.1)
    assert cockpit.view.breach == "outside the fence"
    cockpit.run(2.0)  # the stand-in sends each second that it is inside
    page = cockpit.station.log.build_page(LogRequest(), cockpit.now, cockpit.now)
    assert page is not None
    assert "ArduPilot rover 1: outside the fence" in [line.text for line in page.lines]
    assert cockpit.view.breach == ""


def test_the_capacity_is_that_of_the_vehicles_link() -> None:
    vehicle = FakeArduPilot()
    cockpit = Cockpit(vehicle)
    cockpit.world.near.channel._capacity = 960.0
    cockpit.run(2.0)
    assert requested_rates(vehicle)[m.Attitude.id] == pytest.approx(10 * CAPACITY_SHARE * 960 / LOAD, rel=0.01)


def test_ardupilot_settings_that_let_it_drive_on_are_warned_of() -> None:
    vehicle = FakeVehicle(autopilot=Autopilot.ARDUPILOT)
    vehicle.params.replace(
        {"RC_OVERRIDE_TIME": 3.0, "FS_GCS_ENABLE": 0.0, "FS_THR_ENABLE": 1.0, "MAV_GCS_SYSID": 255.0}
    )
    cockpit = Cockpit(vehicle)
    cockpit.run(3.0)
    assert cockpit.view.warnings == (
        OVERRIDE,
        "FS_GCS_ENABLE 0: no failsafe when the ground station is lost; set it to 1",
    )


OVERRIDE = "RC_OVERRIDE_TIME 3: drives on for 3 s when the link is lost; set it to 0.5"


def test_settings_not_yet_read_are_named_and_read_later() -> None:
    vehicle = FakeArduPilot()
    del vehicle.params["RC_OVERRIDE_TIME"]
    vehicle.params["MAV_GCS_SYSID"] = 255.0
    cockpit = Cockpit(vehicle)
    cockpit.run(6.0)
    words = "could not read, trying again: RC_OVERRIDE_TIME"
    assert words in cockpit.view.warnings
    assert cockpit.texts.count(f"ArduPilot rover 1: {words}") == 1
    vehicle.params["RC_OVERRIDE_TIME"] = 3.0
    cockpit.run(12.0)
    assert words not in cockpit.view.warnings
    assert OVERRIDE in cockpit.view.warnings


@pytest.mark.parametrize("silence", [0.0, 4.0], ids=["fast reboot", "link lost"])
def test_settings_are_read_again_after_a_restart(silence: float) -> None:
    vehicle = FakeArduPilot()
    vehicle.params |= {"RC_OVERRIDE_TIME": 0.5, "FS_GCS_ENABLE": 1.0, "MAV_GCS_SYSID": 255.0}
    cockpit = Cockpit(vehicle)
    cockpit.run(10.0)
    assert not cockpit.view.warnings
    cockpit.world.cut()
    cockpit.run(silence)
    vehicle.reboot()
    vehicle.params |= {"RC_OVERRIDE_TIME": 3.0, "FS_THR_ENABLE": 1.0}
    cockpit.world.cut(False)
    if not silence:
        vehicle.send(m.Attitude(1000, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0))
    cockpit.run(2.0)
    assert cockpit.view.warnings == (OVERRIDE,)
    tells = cockpit.texts.count("ArduPilot rover 1 has restarted: its settings are read again")
    assert tells == (not silence)  # time_boot_ms tells, which this fake sends in the first case only


def test_a_restarted_vehicle_has_a_new_track_and_home() -> None:
    vehicle = FakeArduPilot()
    cockpit = Cockpit(vehicle)
    cockpit.run(10.0)
    vehicle.send(m.HomePosition(0, 0, 0, 5.0, 6.0, 0.0, [1, 0, 0, 0], 0, 0, 0))
    vehicle.send(m.LocalPositionNed(m.boot_ms(cockpit.now), 70.0, 80.0, 0.0, 0.0, 0.0, 0.0))
    cockpit.run(0.1)
    selected = cockpit.station.fleet.selected
    assert selected is not None
    assert (70.0, 80.0) in selected.state.trail.points
    assert cockpit.view.home == (5.0, 6.0)
    vehicle.send(m.Attitude(1000, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0))
    cockpit.run(0.1)
    assert (70.0, 80.0) not in selected.state.trail.points
    assert cockpit.view.home is None
    told = [line.text for line in cockpit.snapshot.texts if "has restarted" in line.text]
    assert told == ["ArduPilot rover 1 has restarted: its settings are read again"]


def test_the_clock_of_another_component_is_no_reboot() -> None:
    vehicle = FakeArduPilot()
    vehicle.params["MAV_GCS_SYSID"] = 255.0
    cockpit = Cockpit(vehicle)
    cockpit.run(3.0)
    before = len(vehicle.all(m.ParamRequestRead))
    camera = m.Attitude(1000, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    cockpit.station.receive(Received(camera, 1, 100, 0, Peer(0, "far"), introduced=True), cockpit.now)
    cockpit.run(2.0)
    assert len(vehicle.all(m.ParamRequestRead)) == before
    assert not [text for text in cockpit.texts if "has restarted" in text]
