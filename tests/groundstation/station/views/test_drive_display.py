"""The Drive screen's part of the snapshot: our vehicle, one like ArduPilot and one like PX4, in virtual time."""

from __future__ import annotations

import math

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mav

from dialects import messages as m
from dialects.enums import Autopilot, DriveType
from groundstation.intents.driving import DriveKeyUp
from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.watch import Watch
from groundstation.ipc import encode
from groundstation.snapshot import VehicleView
from groundstation.snapshot.drive import StopBound
from groundstation.station.component import COMPONENT
from groundstation.station.station import Station
from groundstation.views.base import View
from groundstation.views.drive import SpeedRequest, SpeedView, TrackRequest, TrackView
from link.protocol.channel import Channel
from tests.fakes.rover import FakeArduPilot
from tests.groundstation.cockpits import FORWARD, Cockpit, armed_cockpit, driving_cockpit

SETTINGS = {"FS_GCS_ENABLE": 1.0, "FS_GCS_TIMEOUT": 5.0, "FS_TIMEOUT": 1.5, "FS_ACTION": 2.0}
LARGEST = 8_000
"""Bytes of a snapshot, which is sent ten times a second."""


def ardupilot() -> FakeArduPilot:
    vehicle = FakeArduPilot()
    vehicle.params |= SETTINGS
    vehicle.set_pulses("SERVO1", "SERVO3", "RC1", "RC3")
    return vehicle


def stop(view: VehicleView, source: str) -> StopBound:
    return next(each for each in view.stops if each.source == source)


def views(cockpit: Cockpit) -> list[View]:
    sent: list[View] = []
    cockpit.station.views.send_due(lambda view: not sent.append(view), cockpit.now, 0.0)  # type: ignore[func-returns-value]
    return sent


# ---- our own vehicle ----


def test_key_to_motor_of_our_vehicle_is_in_parts() -> None:
    cockpit = armed_cockpit()
    cockpit.world.up.delay = cockpit.world.down.delay = 0.02
    cockpit.run(1.0)
    cockpit.station.handle_intent(ReportKeyReleases(), cockpit.now)
    cockpit.station.handle_intent(FORWARD, cockpit.now, read_at=cockpit.now - 0.004)
    cockpit.run(0.5)
    way = cockpit.view.key_to_motor
    assert way.key_sent.newest is not None
    assert 0.004 <= way.key_sent.newest <= 0.015
    assert way.sent_heard.newest == pytest.approx(0.02, abs=0.006)
    assert way.total.newest == pytest.approx(sum(each.newest or 0.0 for each in (
        way.key_sent, way.sent_heard, way.heard_motor)))  # fmt: skip


def test_outputs_of_our_vehicle_are_no_measure_of_its_latency() -> None:
    """It reports which demand it obeys; SERVO_OUTPUT_RAW comes later, at 2 Hz."""
    cockpit = armed_cockpit()
    cockpit.vehicle.send(m.RoverDriveStatus(1, 0, 0, 0, [0, 0, 0, 0], 0, 0, 0))
    for _ in range(10):
        cockpit.vehicle.send(m.ServoOutputRaw(0, 0, 1500, 0, 1500, 0, 0, 0, 0, 0))
        cockpit.run(0.1)
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.3)
    before = cockpit.view.key_to_motor
    assert before.total.newest is not None
    cockpit.vehicle.send(m.ServoOutputRaw(0, 0, 1700, 0, 1700, 0, 0, 0, 0, 0))
    cockpit.run(0.1)
    assert cockpit.view.key_to_motor == before


def test_the_bars_of_our_vehicle_fill_when_the_link_is_cut() -> None:
    cockpit = driving_cockpit()
    cockpit.vehicle.params |= {"FS_GCS_ENABLE": 1.0, "FS_GCS_TIMEOUT": 5.0, "OPR_TIMEOUT": 10.0}
    info = m.RoverDriveInfo(2.0, 1.0, 0.4, math.nan, 450, DriveType.SKID, 0, 3, 0, 2)
    cockpit.vehicle.send(info)
    cockpit.run(1.0)
    shares = [stop(cockpit.view, source).share for source in ("MAN_TIMEOUT", "FS_GCS_TIMEOUT")]
    assert all(share is not None and share < 0.25 for share in shares), shares
    assert cockpit.view.speed_demand == pytest.approx(1.2)
    cockpit.world.cut()
    cockpit.run(2.5)
    assert stop(cockpit.view, "MAN_TIMEOUT").share == 1.0
    assert stop(cockpit.view, "FS_GCS_TIMEOUT").share == pytest.approx(0.5, abs=0.05)


def test_no_key_counts_only_while_a_demand_moves_the_vehicle() -> None:
    cockpit = driving_cockpit()
    cockpit.vehicle.params["OPR_TIMEOUT"] = 10.0
    cockpit.run(4.0)
    assert stop(cockpit.view, "OPR_TIMEOUT").share == pytest.approx(0.45, abs=0.02)
    cockpit.do(DriveKeyUp(key="i"))
    cockpit.run(0.2)
    assert stop(cockpit.view, "OPR_TIMEOUT").value is None


# ---- foreign vehicles ----


def test_an_ardupilot_tells_by_its_parameters_and_outputs() -> None:
    vehicle = ardupilot()
    cockpit = Cockpit(vehicle)
    cockpit.world.up.delay = cockpit.world.down.delay = 0.01
    cockpit.run(6.0)
    assert [each.bound for each in cockpit.view.stops] == [3.0, 0.5, 2.0, 6.5]
    driving = armed_cockpit(ardupilot())
    driving.run(6.0)
    driving.do(ReportKeyReleases(), FORWARD)
    driving.run(1.0)
    view = driving.view
    assert view.demand == pytest.approx((0.6, 0.0))
    assert [output.value for output in view.outputs] == pytest.approx([0.0, 0.6])
    assert view.key_to_motor.total.newest is not None
    assert 0.0 <= view.key_to_motor.total.newest <= 0.25, "SERVO_OUTPUT_RAW comes at 5 Hz"
    assert view.command_age_estimated
    assert view.command_age == pytest.approx(0.025, abs=0.03)
    assert stop(view, "RC_OVERRIDE_TIME").estimated


def test_the_bars_of_an_ardupilot_fill_when_the_link_is_cut() -> None:
    cockpit = armed_cockpit(ardupilot())
    cockpit.run(6.0)
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(1.0)
    before = stop(cockpit.view, "RC_OVERRIDE_TIME").share
    assert before is not None
    assert before < 0.1
    cockpit.world.cut()
    cockpit.run(2.0)
    assert stop(cockpit.view, "RC_OVERRIDE_TIME").share == pytest.approx(0.67, abs=0.05)
    assert stop(cockpit.view, "FS_GCS_ENABLE").share == pytest.approx(0.31, abs=0.03)


def test_a_changed_parameter_changes_the_bound_at_once() -> None:
    vehicle = ardupilot()
    cockpit = Cockpit(vehicle)
    cockpit.run(6.0)
    vehicle.send(m.ParamValue(b"FS_GCS_TIMEOUT", 2.0, 9, 1, 0xFFFF))
    cockpit.run(0.1)
    assert stop(cockpit.view, "FS_GCS_ENABLE").bound == 3.5


def test_a_px4_tells_its_actuators_and_its_failsafes() -> None:
    vehicle = FakeArduPilot(autopilot=Autopilot.PX4)
    vehicle.params.replace({"COM_RC_LOSS_T": 0.5, "NAV_RCL_ACT": 1.0, "COM_DL_LOSS_T": 10.0, "NAV_DLL_ACT": 0.0})
    cockpit = Cockpit(vehicle)
    cockpit.run(6.0)
    assert [(each.source, each.bound, each.never) for each in cockpit.view.stops] == [
        ("COM_RC_LOSS_T", 0.5, False), ("NAV_RCL_ACT", None, False), ("COM_DL_LOSS_T", None, True),
    ]  # fmt: skip
    assert [(output.name, output.value) for output in cockpit.view.outputs] == [("output 1", 0.0), ("output 2", -0.5)]
    assert cockpit.view.demand is None


# ---- sizes and views ----


def test_the_largest_snapshot_is_small() -> None:
    """Everything that a vehicle can tell, as pymavlink builds it: long texts, warnings, a mission, all sensors bad."""
    station = Station(["udpin:127.0.0.1:14550"], system=255)
    channel = Channel("memory", 0, system=255, component=COMPONENT)
    sender = mav.MAVLink(None, srcSystem=1, srcComponent=1)
    every = (1 << 31) - 1
    messages = [
        mav.MAVLink_heartbeat_message(10, 3, 209, 0, 4, 3),
        mav.MAVLink_sys_status_message(every, every, 0, 300, 12100, 190, 12, 0, 0, 0, 0, 0, 0),
        mav.MAVLink_ekf_status_report_message(0, 2.0, 2.0, 0.0, 2.0, 0.0),
        mav.MAVLink_vibration_message(0, 99.0, 99.0, 99.0, 9999, 9999, 9999),
        mav.MAVLink_gps_raw_int_message(0, 3, 0, 0, 0, 80, 65535, 0, 0, 14),
        mav.MAVLink_mission_current_message(3, 200),
        *(mav.MAVLink_local_position_ned_message(0, 0.3 * step, 0.7 * step, 0, 1, 1, 0) for step in range(500)),
        *(mav.MAVLink_statustext_message(4, (f"{number}" * 50)[:50].encode()) for number in range(20)),
    ]
    for number, message in enumerate(messages):
        for received in channel.receive(message.pack(sender), "vehicle", number / 100):
            station.receive(received, number / 100)
        sender.seq = (sender.seq + 1) % 256
        station.tick(number / 100)
    station.observe([channel.report(now=6.0)], 6.0)
    snapshot = station.snapshot(6.0, 6.0)
    assert snapshot.vehicle is not None
    assert len(snapshot.vehicle.health) > 25
    assert snapshot.vehicle.mission is not None
    assert len(encode(snapshot)) < LARGEST


def test_the_track_is_a_view() -> None:
    vehicle = ardupilot()
    cockpit = Cockpit(vehicle)
    cockpit.run(6.0)
    cockpit.do(Watch((TrackRequest(),)))
    for step in range(5):
        vehicle.send(m.LocalPositionNed(m.boot_ms(cockpit.now), 10.0 * step, 0.0, 0.0, 0.0, 0.0, 0.0))
        cockpit.run(0.05)
    (track,) = views(cockpit)
    assert isinstance(track, TrackView)
    assert track.system == 1
    assert track.points[-1] == (40.0, 0.0)


def test_speed_and_demand_of_the_last_minute_are_a_view() -> None:
    cockpit = driving_cockpit()
    cockpit.vehicle.send(m.RoverDriveInfo(2.0, 1.0, 0.4, math.nan, 450, DriveType.SKID, 0, 3, 0, 2))
    cockpit.run(0.1)
    cockpit.do(Watch((SpeedRequest(),)))
    for _ in range(80):
        cockpit.vehicle.send(m.VfrHud(0.0, 0.8, 0, 0, 0.0, 0.0))
        cockpit.run(1.0)
    (speeds,) = views(cockpit)
    assert isinstance(speeds, SpeedView)
    times = [at for at, _, _ in speeds.points]
    assert 59.0 <= times[-1] - times[0] <= 60.0
    assert len(times) == pytest.approx(120, abs=3)
    _, speed, demanded = speeds.points[-1]
    assert speed == pytest.approx(0.8)
    assert demanded == pytest.approx(1.2)
