"""Views of the Links screen in virtual time, with 1, 2 and 20 vehicles."""

from __future__ import annotations

from itertools import pairwise

import pytest

from dialects import messages as m
from dialects.enums import Command, ControlFlag, Result, VehicleType
from groundstation.intents.driving import DriveKeyDown
from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.vehicle import SelectVehicle
from groundstation.ipc import MAX_PACKET, encode
from groundstation.vehicles.state.vehicle_heartbeat import MAX_VEHICLES
from groundstation.views.base import ViewRequest
from groundstation.views.links import (
    ControlRequest,
    ControlView,
    LinksRequest,
    LinksView,
    Program,
    VehiclesRequest,
    VehiclesView,
)
from link.core import Received
from link.protocol.channel import Channel
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.flotilla import SESSION, Flotilla
from tests.world import Host

ALL: tuple[ViewRequest, ...] = (VehiclesRequest(), LinksRequest(), ControlRequest())


def place(flotilla: Flotilla, system: int, latitude: float, longitude: float) -> None:
    flotilla.vehicles[system].send(
        m.GlobalPositionInt(0, round(latitude * 1e7), round(longitude * 1e7), 0, 0, 0, 0, 0, 0)
    )


@pytest.fixture
def one() -> Flotilla:
    """One vehicle, and the screen is open."""
    flotilla = Flotilla(1)
    flotilla.run(2.0)
    flotilla.watch(*ALL)
    return flotilla


@pytest.fixture
def two() -> Flotilla:
    """Two of them."""
    flotilla = Flotilla(2)
    flotilla.run(2.0)
    flotilla.watch(*ALL)
    return flotilla


def versions_requested(flotilla: Flotilla) -> int:
    asked = flotilla.vehicles[1].commands(Command.REQUEST_MESSAGE)
    return sum(each.param1 == m.AutopilotVersion.id for each in asked)


def test_nothing_is_sent_or_requested_for_a_hidden_screen() -> None:
    flotilla = Flotilla(2)
    flotilla.run(3.0)
    assert (flotilla.views, versions_requested(flotilla)) == ([], 0)
    flotilla.watch(*ALL)
    flotilla.run(0.5)
    assert (len(flotilla.views) >= 3, versions_requested(flotilla)) == (True, 1)


def test_refused_version_does_not_end_the_search_for_our_dialect(one: Flotilla) -> None:
    """Both are REQUEST_MESSAGE; only the answer to ROVER_DRIVE_INFO says that a vehicle is foreign."""
    vehicle = one.vehicles[1]
    accept = vehicle.receive

    def refuse_version(received: Received, now: float) -> None:
        about_version = getattr(received.message, "param1", None) == m.AutopilotVersion.id
        vehicle.answers[Command.REQUEST_MESSAGE] = Result.UNSUPPORTED if about_version else Result.ACCEPTED
        accept(received, now)

    vehicle.receive = refuse_version  # type: ignore[method-assign]
    one.run(8.0)
    assert versions_requested(one)
    before = len(vehicle.commands(Command.REQUEST_MESSAGE))
    one.run(60.0)
    later = vehicle.commands(Command.REQUEST_MESSAGE)[before:]
    assert {int(each.param1) for each in later} == {m.RoverDriveInfo.id}


def test_views_come_twice_a_second_and_end_with_the_screen(two: Flotilla) -> None:
    two.run(5.0)
    times = [at for at, view in two.views if isinstance(view, VehiclesView)]
    assert 8 <= len(times) <= 11
    assert min(b - a for a, b in pairwise(times)) >= 0.5
    two.watch()
    count = len(two.views)
    two.run(3.0)
    assert len(two.views) == count


def test_one_vehicle(one: Flotilla) -> None:
    (row,) = one.newest(VehiclesView).rows
    assert (row.system, row.name, row.mode, row.armed, row.alive) == (1, "Rover 1", "MANUAL", False, True)
    assert (row.driver, row.in_control, row.has_position, row.distance) == (0, False, False, None)
    assert row.silence <= 1.1
    assert row.state == "standby"
    one.vehicles[1].armed = True
    one.vehicles[1].driver = 250
    one.run(1.5)
    (row,) = one.newest(VehiclesView).rows
    assert (row.armed, row.driver, row.state) == (True, 250, "active")


def test_battery_version_and_components(one: Flotilla) -> None:
    camera = FakeVehicle()
    camera.tick = lambda now: None if round(now * 50) % 50 else camera.send(m.Heartbeat(30, 8, 0, 0, 4, 3))  # type: ignore[method-assign]
    one.join(camera, 1, 100)
    vehicle = one.vehicles[1]
    vehicle.send(m.BatteryStatus(0, 0, 0, 0, [11_800] + [0xFFFF] * 9, 240, 0, 0, 76))
    vehicle.send(m.AutopilotVersion(0, 4 << 24 | 6 << 16 | 1 << 8, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 0))
    one.run(1.0)
    (row,) = one.newest(VehiclesView).rows
    assert (row.battery_voltage, row.battery_remaining, row.firmware) == (11.8, 0.76, "4.6.1")
    assert [(each.component, each.kind) for each in row.components] == [(100, "camera")]


def test_the_version_is_requested_three_times_at_most(one: Flotilla) -> None:
    one.run(20.0)
    assert versions_requested(one) == 3


def test_distances_are_from_the_selected_vehicle_and_from_home(two: Flotilla) -> None:
    place(two, 1, -35.0, 149.0)
    place(two, 2, -35.0, 149.001)
    two.vehicles[1].send(m.HomePosition(round(-35.001e7), round(149e7), 0, 0, 0, 0, [1, 0, 0, 0], 0, 0, 0))
    first, second = two.newest(VehiclesView).rows
    assert (first.distance, first.bearing) == pytest.approx((111.3, 0), abs=0.1)
    assert (second.distance, second.bearing) == pytest.approx((91.2, 90), abs=0.1)
    two.station.handle_intent(SelectVehicle(system=2), two.now)
    first, second = two.newest(VehiclesView).rows
    assert (first.distance, first.bearing) == pytest.approx((91.2, 270), abs=0.1)
    assert (second.distance, second.has_position) == (None, True), "its home is not known"


def test_no_position_is_none_until_there_is_a_fix(two: Flotilla) -> None:
    place(two, 1, 0.0, 0.0)
    two.vehicles[2].send(m.GlobalPositionInt(0, 2_000_000_000, 0, 0, 0, 0, 0, 0, 0))
    assert [row.has_position for row in two.newest(VehiclesView).rows] == [False, False]


def test_a_lost_vehicle_that_was_armed_stays_in_the_list(two: Flotilla) -> None:
    two.vehicles[2].armed = True
    two.run(1.5)
    del two.far["10.0.0.2:14550"]
    two.far["10.0.0.2:14550"] = Host(FakeVehicle(system=99), Channel("deaf", 0, system=99, component=1), 1e9)
    two.run(10.0)
    row = two.newest(VehiclesView).rows[1]
    assert (row.system, row.alive, row.armed) == (2, False, True)
    assert row.silence > 9.0


def test_vehicles_beyond_the_limit_are_counted_and_all_rows_fit() -> None:
    flotilla = Flotilla(MAX_VEHICLES + 4)
    for vehicle in flotilla.vehicles.values():
        vehicle.armed = True
    flotilla.run(1.5)
    flotilla.watch(*ALL)
    view = flotilla.newest(VehiclesView)
    assert [row.system for row in view.rows] == list(range(1, MAX_VEHICLES + 1))
    assert view.not_shown == 4
    assert len(encode(view)) < MAX_PACKET
    assert len(encode(flotilla.station.snapshot(flotilla.now, 0.0))) < 8000


def test_choosing_another_vehicle_sends_neutral_to_driven_one() -> None:
    flotilla = Flotilla(20)
    flotilla.run(2.0)
    flotilla.watch(*ALL)
    vehicle = flotilla.vehicles[1]
    vehicle.armed, vehicle.driver = True, 255
    flotilla.run(1.5)
    for intent in (ReportKeyReleases(), DriveKeyDown(key="i", throttle=1, steering=0)):
        flotilla.station.handle_intent(intent, flotilla.now)
    flotilla.run(0.5)
    assert vehicle.all(m.ManualControl)[-1][1].x == 600
    left = flotilla.now
    flotilla.station.handle_intent(SelectVehicle(system=7), flotilla.now)
    flotilla.run(2.0)
    after = [each.x for at, each in vehicle.all(m.ManualControl) if at > left]
    assert after
    assert set(after) == {0}
    assert flotilla.newest(ControlView).vehicle == "Rover 7"
    assert flotilla.station.snapshot(flotilla.now, 0.0).also_armed == (1,)


# ---- control ----


def control_message(session: int, system: int, component: int, flags: int = 0) -> m.RoverControl:
    return m.RoverControl(session, system, component, flags)


def test_a_vehicle_that_does_not_tell() -> None:
    flotilla = Flotilla(1)
    flotilla.vehicles[1].driver = None
    flotilla.run(2.0)
    flotilla.watch(*ALL)
    view = flotilla.newest(ControlView)
    assert (view.vehicle, view.driver, view.program, view.age, view.in_control) == ("Rover 1", None, None, None, False)
    assert view.ours == Program(255, 190, SESSION)


def test_the_program_in_control_and_its_flags(one: Flotilla) -> None:
    vehicle = one.vehicles[1]
    vehicle.driver = 250
    vehicle.send(control_message(42, 250, 191, ControlFlag.CLASH | ControlFlag.SILENT | 128))
    one.run(1.0)
    view = one.newest(ControlView)
    assert (view.driver, view.program) == (250, Program(250, 191, 42))
    assert (view.clash, view.silent, view.takeover) == (True, True, False)
    vehicle.send(control_message(0, 0, 0, ControlFlag.TAKEOVER_ALLOWED))
    view = one.newest(ControlView)
    assert (view.program, view.clash, view.silent, view.takeover) == (None, False, False, True)


def test_the_age_of_the_report_grows_when_it_stops(one: Flotilla) -> None:
    one.run(1.0)
    age = one.newest(ControlView).age
    assert age is not None
    assert age <= 1.1
    one.vehicles[1].driver = None
    one.run(6.0)
    view = one.newest(ControlView)
    assert view.driver == 0, "it is what the vehicle said last"
    assert view.age is not None
    assert view.age > 5.0


def test_other_ground_stations_are_listed_while_they_are_heard(one: Flotilla) -> None:
    station = FakeVehicle()
    beat = m.Heartbeat(VehicleType.GCS, 8, 0, 0, 4, 3)
    station.tick = lambda now: None  # type: ignore[method-assign]
    one.join(station, 250, 190)
    station.send(beat)
    view = one.newest(ControlView)
    assert [(each.system, each.component) for each in view.stations] == [(250, 190)]
    one.run(11.0)
    assert one.newest(ControlView).stations == ()


def test_without_a_vehicle_there_are_views_all_the_same() -> None:
    flotilla = Flotilla(0)
    flotilla.watch(*ALL)
    flotilla.run(2.0)
    assert flotilla.newest(VehiclesView) == VehiclesView(())
    assert flotilla.newest(ControlView).vehicle == ""
    assert [row.name for row in flotilla.newest(LinksView).rows] == ["near"]


def test_links_name_their_peers_and_time_the_selected_vehicle(two: Flotilla) -> None:
    two.run(3.0)
    (row,) = two.newest(LinksView).rows
    assert (row.peers, row.peer_count) == (("10.0.0.1:14550", "10.0.0.2:14550"), 2)
    assert row.frames_in > 1.0
    assert row.bytes_in > 0
    assert row.loss == 0.0
    assert row.round_trip is not None
    assert (row.capacity, row.share, row.problem) == (None, None, None)
