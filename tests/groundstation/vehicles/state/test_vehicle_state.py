"""How each message changes the state; no message can raise."""

from __future__ import annotations

import math
import struct

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import messages as m
from dialects.codec import decode
from dialects.enums import Autopilot, DriveType, Sensor, SystemState
from groundstation.ipc import decode_from_station, encode
from groundstation.snapshot import VehicleView
from groundstation.station.station import Station
from groundstation.vehicles.state.vehicle_state import VehicleState
from link.core import Peer, Received

PEER = Peer(0, "vehicle")


def received(message: m.Message, component: int = 1, system: int = 1) -> Received:
    return Received(message, system, component, 0, PEER, True)


def state(*messages: m.Message, now: float = 10.0) -> VehicleState:
    vehicle = VehicleState(1, 1)
    for message in messages:
        vehicle.receive(received(message), now)
    return vehicle


def view(*messages: m.Message, at: float = 10.0) -> VehicleView:
    return state(*messages).build_view(at)


def heartbeat(mode: int = 0, base: int = 1, autopilot: int = 0, status: int = SystemState.STANDBY) -> m.Heartbeat:
    return m.Heartbeat(10, autopilot, base, mode, status, 3)


def fence_bits(*, healthy: bool, enabled: bool = True) -> m.SysStatus:
    fence = int(Sensor.GEOFENCE)
    return m.SysStatus(fence, fence * enabled, fence * healthy, 0, 11800, -1, 73, 0, 0, 0, 0, 0, 0)


def test_a_breach_of_a_foreign_fence_is_named() -> None:
    beat = heartbeat(autopilot=Autopilot.ARDUPILOT)
    assert view(beat, fence_bits(healthy=False)).breach == "outside the fence"
    assert view(beat, m.FenceStatus(1, 1, 3, 104172, 1)).breach == "outside the fence"
    assert view(beat, m.FenceStatus(1, 1, 2, 104172, 0)).breach == "above the highest altitude of the fence"
    assert view(beat, fence_bits(healthy=False), fence_bits(healthy=True)).breach == ""
    assert view(beat, m.FenceStatus(1, 1, 3, 104172, 1), m.FenceStatus(0, 1, 0, 0, 1)).breach == ""
    assert view(beat, m.FenceStatus(1, 1, 3, 104172, 1), fence_bits(healthy=True)).breach == ""
    assert view(beat, fence_bits(healthy=False, enabled=False)).breach == ""


def test_heartbeat() -> None:
    seen = view(heartbeat(mode=4, base=1 | 128, status=SystemState.ACTIVE))
    assert (seen.mode, seen.armed, seen.status, seen.name) == ("HOLD", True, SystemState.ACTIVE, "Rover 1")


@pytest.mark.parametrize(
    ("kind", "autopilot", "name"),
    [
        (10, 0, "Rover 1"),
        (10, 3, "ArduPilot rover 1"),
        (11, 12, "PX4 boat 1"),
        (2, 0, "Copter 1"),
        (99, 77, "Vehicle 1"),
    ],
)
def test_names(kind: int, autopilot: int, name: str) -> None:
    assert view(m.Heartbeat(kind, autopilot, 1, 0, 3, 3)).name == name


def test_alive_until_no_message_arrives() -> None:
    vehicle = state(heartbeat())
    assert vehicle.build_view(12.4).alive
    assert vehicle.build_view(12.4).silence == pytest.approx(2.4)
    assert not vehicle.build_view(12.6).alive


def test_any_component_keeps_link_but_the_autopilot_sets_state() -> None:
    vehicle = state(heartbeat(mode=4))
    vehicle.receive(received(m.Heartbeat(30, 8, 0, 0, 3, 3), component=154), 20.0)
    assert vehicle.build_view(20.0).alive
    assert vehicle.build_view(20.0).mode == "HOLD"


def test_attitude_and_heading_wrap() -> None:
    seen = view(m.Attitude(0, 0.1, -0.2, -math.pi / 2, 0, 0, 0))
    assert seen.roll == pytest.approx(0.1)
    assert seen.pitch == pytest.approx(-0.2)
    assert seen.heading == pytest.approx(1.5 * math.pi)


def test_speed_has_the_sign_of_the_nose() -> None:
    seen = view(m.Attitude(0, 0, 0, math.pi / 2, 0, 0, 0), m.LocalPositionNed(0, 1.0, 2.0, 0, 0.0, -0.5, 0))
    assert seen.speed == pytest.approx(-0.5)
    assert seen.position == (1.0, 2.0)


def test_speed_over_ground_is_better_than_none() -> None:
    assert view(m.VfrHud(0, 1.5, 90, 0, 0, 0)).speed == 1.5
    assert view(m.VfrHud(0, 1.5, 90, 0, 0, 0)).heading == pytest.approx(math.pi / 2)


def test_global_position_is_used_where_there_is_no_local_one() -> None:
    def at(lat: int, lon: int) -> m.GlobalPositionInt:
        return m.GlobalPositionInt(0, lat, lon, 0, 0, 0, 0, 0, 65535)

    seen = view(at(0, 0), at(600000000, 100000000), at(600010000, 100000000))
    assert seen.position is not None
    assert seen.position[0] == pytest.approx(111.3, abs=0.1)
    assert state(at(600000000, 100000000), at(600010000, 100000000)).trail.points[0] == (0.0, 0.0)


def battery(volts: list[int], current: int, remaining: int, number: int = 0) -> m.BatteryStatus:
    return m.BatteryStatus(number, 0, 0, 0, volts + [65535] * (10 - len(volts)), current, -1, -1, remaining)


def test_battery_from_its_cells() -> None:
    seen = view(battery([4100, 4150, 4120], 250, 80))
    assert seen.battery_voltage == pytest.approx(12.37)
    assert (seen.battery_current, seen.battery_remaining) == (2.5, 0.8)


def test_unknown_battery_values_stay_unknown() -> None:
    seen = view(battery([], -1, -1))
    assert (seen.battery_voltage, seen.battery_current, seen.battery_remaining) == (None, None, None)
    assert view(battery([4100], 1, 1, number=1)).battery_voltage is None


def test_drive_status() -> None:
    status = m.RoverDriveStatus(5000, 40, 6000, -2500, [5000, -10000, 0, 0], 1 | 1024, 255, 7)
    seen = view(heartbeat(), status)
    assert seen.demand == (0.6, -0.25)
    assert [(output.name, output.value) for output in seen.outputs] == [("motor 1", 0.5), ("motor 2", -1.0)]
    assert seen.limits == ("slew", "neutral first")
    assert state(heartbeat(), status).command_age(10.0) == 0.04
    assert state(heartbeat(), status).command_age(12.0) == pytest.approx(2.04), "an old report ages"
    assert view(heartbeat(), status, at=13.0).demand is None, "an old word is not shown as if it were true now"


def test_emergency_stop_is_seen_by_status_or_limit() -> None:
    assert state(heartbeat(status=SystemState.EMERGENCY)).emergency_stop
    for autopilot in (Autopilot.ARDUPILOT, Autopilot.PX4):  # a crash, a failsafe: not our lock of the motors
        assert not state(heartbeat(autopilot=autopilot, status=SystemState.EMERGENCY)).emergency_stop


def sys_status(*, present: int = Sensor.PREARM, health: int = 0) -> m.SysStatus:
    return m.SysStatus(present, present, health, 0, 12000, 100, 80, 0, 0, 0, 0, 0, 0)


def test_pre_arm_checks() -> None:
    assert view(sys_status(present=0, health=Sensor.PREARM)).prearm is None
    vehicle = state(sys_status())
    vehicle.handle_text("PreArm: Accels inconsistent")
    vehicle.handle_text("EKF3 active")
    seen = vehicle.build_view(10.0)
    assert (seen.prearm, seen.prearm_reason, vehicle.ready_at) == (False, "PreArm: Accels inconsistent", None)
    for now in (20.0, 21.0):
        vehicle.receive(received(sys_status(health=Sensor.PREARM)), now)
    vehicle.handle_text("PreArm: late")
    seen = vehicle.build_view(21.0)
    assert (seen.prearm, seen.prearm_reason, vehicle.ready_at) == (True, "", 20.0)


def test_a_restart_forgets_where_the_vehicle_was() -> None:
    there = m.LocalPositionNed(1000, 50.0, 60.0, 0.0, 0.0, 0.0, 0.0)
    vehicle = state(heartbeat(), there, m.HomePosition(0, 0, 0, 1.0, 2.0, 0.0, [1, 0, 0, 0], 0, 0, 0), sys_status())
    before = vehicle.build_view(10.0)
    assert (before.position, before.home, len(vehicle.trail.points)) == ((50.0, 60.0), (1.0, 2.0), 1)
    vehicle.restart()
    after = vehicle.build_view(10.0)
    assert (after.position, after.home, vehicle.trail.points, after.prearm) == (None, None, (), None)
    assert after.mode == before.mode
    assert state(heartbeat(), m.RoverDriveStatus(0, 0, 0, 0, [0] * 4, 64, 0, 0)).emergency_stop
    assert not state(heartbeat()).emergency_stop


def test_failsafe_countdown_runs_between_messages() -> None:
    vehicle = state(m.RoverFailsafeStatus(0, 1 | 2, 0, 3000, 4, 0))
    assert vehicle.build_view(10.0).failsafes == ("manual loss", "gcs loss")
    assert vehicle.build_view(11.0).failsafe_in == pytest.approx(2.0)
    assert vehicle.build_view(99.0).failsafe_in == 0.0
    assert view(m.RoverFailsafeStatus(0, 0, 0, 65535, 0, 0)).failsafe_in is None


def drive_info(kind: DriveType, motors: int) -> m.RoverDriveInfo:
    return m.RoverDriveInfo(1.5, 3.0, 0.4, 0.3, 450, kind, 0, 3, 0, motors)


@pytest.mark.parametrize(
    ("kind", "motors", "names"),
    [
        (DriveType.SKID, 2, ["left wheel", "right wheel"]),
        (DriveType.ACKERMANN, 2, ["throttle", "steering servo"]),
        (DriveType.MECANUM, 4, ["motor 1", "motor 2", "motor 3", "motor 4"]),
        (DriveType.UNKNOWN, 2, ["motor 1", "motor 2"]),
    ],
)
def test_outputs_are_named_by_the_arrangement_of_the_wheels(kind: DriveType, motors: int, names: list[str]) -> None:
    status = m.RoverDriveStatus(5000, 40, 0, 0, [5000, -10000, 0, 0], 0, 255, 7)
    assert [output.name for output in view(heartbeat(), drive_info(kind, motors), status).outputs] == names


SERVOS = m.ServoOutputRaw(0, 0, 2000, 1750, 1250, 0, 0xFFFF, 0, 0, 0)


def test_not_a_number_is_not_shown() -> None:
    seen = view(
        m.Attitude(0, math.nan, math.inf, math.nan, 0, 0, 0),
        m.LocalPositionNed(0, math.nan, 0, 0, 0, 0, 0),
        m.VfrHud(0, math.nan, 0, 0, 0, 0),
    )
    assert (seen.roll, seen.pitch, seen.position, seen.speed) == (None, None, None, None)


_ANY_MESSAGE = st.sampled_from(sorted(m.MESSAGES)).flatmap(
    lambda number: st.tuples(st.just(number), st.binary(max_size=m.MESSAGES[number].unpacker.size))
)


@given(st.lists(st.tuples(_ANY_MESSAGE, st.sampled_from([1, 2, 255]), st.sampled_from([1, 190])), max_size=30))
@settings(max_examples=200)
def test_no_message_breaks_the_station(frames: list[tuple[tuple[int, bytes], int, int]]) -> None:
    station, now = Station(["udpin:127.0.0.1:14550"]), 0.0
    station.receive(received(heartbeat(autopilot=Autopilot.ARDUPILOT)), now)
    for (number, payload), system, component in frames:
        now += 0.1
        try:
            message = decode(number, payload)
        except (UnicodeDecodeError, struct.error):
            continue
        station.receive(received(message, component, system), now)
        station.tick(now)
        assert decode_from_station(encode(station.snapshot(now, now)))
