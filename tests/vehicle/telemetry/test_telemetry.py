"""What the vehicle tells: rates, truth, and no reading that it cannot put into a message."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import fields, replace

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import Autopilot, Command, DriveLimit, DriveType, Sensor, SystemState, VehicleType
from link.core import LinkReport
from tests.examples import examples
from tests.vehicle.bench import AHEAD, DRIVER, EVERYTHING, NEUTRAL, OTHER, Bench, said
from vehicle.readings import Readings

RATES = {
    m.Heartbeat: 1, m.SysStatus: 1, m.BatteryStatus: 0.5, m.CurrentMode: 0.5, m.ControlStatus: 1, m.SystemTime: 1,
    m.VfrHud: 4, m.Attitude: 4, m.GlobalPositionInt: 2, m.LocalPositionNed: 4, m.GpsRawInt: 1, m.ServoOutputRaw: 2,
    m.RcChannels: 2, m.RoverDriveStatus: 5, m.RoverFailsafeStatus: 1, m.EstimatorStatus: 1,
}  # fmt: skip
"""The design's "streams at start", Hz."""


def counts(bench: Bench, seconds: float) -> dict[type[m.Message], float]:
    before = len(bench.sent)
    bench.wait(seconds)
    return {kind: sum(isinstance(each, kind) for each in bench.sent[before:]) / seconds for kind in RATES}


def equipped(**params: float) -> Bench:
    bench = Bench(**params)
    bench.readings = EVERYTHING
    bench.wait(1.0)
    return bench


def test_streams_at_start() -> None:
    assert counts(equipped(), 20.0) == pytest.approx(RATES, abs=0.1)


def test_without_sensors_it_tells_only_what_it_knows() -> None:
    bench = Bench()
    bench.wait(3.0)
    assert not bench.all(m.Attitude)
    assert not bench.all(m.GpsRawInt)
    assert not bench.all(m.BatteryStatus)
    status = bench.newest(m.SysStatus)
    assert status.onboard_control_sensors_present == Sensor.MOTOR_OUTPUTS | Sensor.PREARM
    assert status.voltage_battery == m.UINT16_MAX


def test_the_first_word_is_a_heartbeat_with_the_right_ids() -> None:
    beat = Bench().sent[0]
    assert isinstance(beat, m.Heartbeat)
    assert (beat.type, beat.autopilot, beat.system_status) == (
        VehicleType.GROUND_ROVER,
        Autopilot.GENERIC,
        SystemState.STANDBY,
    )


def test_health_is_told_truthfully() -> None:
    bench = equipped()
    status = bench.newest(m.SysStatus)
    present, health = status.onboard_control_sensors_present, status.onboard_control_sensors_health
    assert present == status.onboard_control_sensors_enabled
    assert present & Sensor.BATTERY
    assert present & Sensor.GPS
    assert present & health == present
    assert not present & Sensor.GEOFENCE
    assert health & Sensor.GEOFENCE  # MAVProxy would cry "fence breach"
    bench.rover.motor_failed("broken", bench.now)
    bench.readings = replace(EVERYTHING, gps_fix=1)
    bench.wait(1.1)
    health = bench.newest(m.SysStatus).onboard_control_sensors_health
    assert not health & (Sensor.MOTOR_OUTPUTS | Sensor.PREARM | Sensor.GPS)


def test_who_is_armed_could_arm() -> None:
    """Ground stations show the bit as a fault of the vehicle, and a stick that moves is none."""
    bench = equipped()
    bench.drive()
    bench.wait(1.5, AHEAD)
    assert bench.turning
    assert bench.newest(m.SysStatus).onboard_control_sensors_health & Sensor.PREARM


def test_numbers_arrive_in_their_units() -> None:
    bench = equipped()
    gps, position, battery = bench.newest(m.GpsRawInt), bench.newest(m.GlobalPositionInt), bench.newest(m.BatteryStatus)
    assert (gps.fix_type, gps.lat, gps.eph, gps.vel, gps.cog, gps.satellites_visible) == (
        3,
        481000000,
        80,
        71,
        4500,
        12,
    )
    assert (position.alt, position.relative_alt, position.hdg) == (500_000, 0, 4500)
    assert (battery.voltages[0], battery.current_battery, battery.battery_remaining) == (12_000, 100, 90)
    assert bench.newest(m.Attitude).yaw == pytest.approx(math.pi / 4)
    assert bench.newest(m.VfrHud).groundspeed == pytest.approx(0.7, abs=1e-3)  # the wheels are trusted, not wholly


@pytest.mark.parametrize("altitude", [None, math.nan, math.inf])
def test_without_a_height_it_is_as_high_as_home(altitude: float | None) -> None:
    bench = equipped()
    bench.readings = replace(bench.readings, altitude=altitude)  # as when a receiver has satellites for 2D only
    bench.wait(1.0)
    position = bench.newest(m.GlobalPositionInt)
    assert (position.alt, position.relative_alt) == (0, 0)
    assert bench.newest(m.LocalPositionNed).z == 0.0


def test_a_changed_demand_is_told_at_once_with_its_packet_number() -> None:
    bench = Bench()
    bench.drive()
    count = len(bench.all(m.RoverDriveStatus))
    bench.wait(0.06, AHEAD)
    bench.now += 0.001
    bench.stick(Axes(throttle=0.5))
    told = bench.newest(m.RoverDriveStatus)
    assert len(bench.all(m.RoverDriveStatus)) == count + 1
    assert (told.demand_throttle, told.source_system, told.demand_age_ms) == (5000, DRIVER, 0)
    demand = bench.rover._control.demand
    assert demand is not None
    assert told.source_seq == demand.sequence


def test_changes_are_told_20_times_a_second_at_most() -> None:
    bench = Bench()
    bench.drive()
    count = len(bench.all(m.RoverDriveStatus))
    for number in range(200):
        bench.stick(Axes(throttle=0.5 + number / 1000))
        bench.wait(0.01)
    assert 30 <= len(bench.all(m.RoverDriveStatus)) - count <= 41


def test_the_drive_status_says_why_nothing_moves() -> None:
    bench = Bench()
    bench.wait(0.2)
    assert bench.newest(m.RoverDriveStatus).limits & DriveLimit.DISARMED
    assert bench.newest(m.RoverDriveStatus).demand_age_ms == m.UINT16_MAX
    bench.arm()
    bench.wait(0.2, AHEAD)
    told = bench.newest(m.RoverDriveStatus)
    assert told.limits == DriveLimit.NEUTRAL_FIRST
    assert told.demand_throttle == 10_000
    bench.wait(0.1, NEUTRAL)
    bench.wait(0.1, AHEAD)
    assert bench.newest(m.RoverDriveStatus).limits == DriveLimit.SLEW
    bench.wait(0.8)
    told = bench.newest(m.RoverDriveStatus)
    assert told.limits & DriveLimit.STALE
    assert told.limits & DriveLimit.FAILSAFE
    assert told.demand_throttle == 0
    assert 600 < told.demand_age_ms <= 850


def test_full_ahead_and_full_turn_is_told_as_saturated() -> None:
    bench = Bench()
    bench.drive(Axes(1.0, 1.0))
    assert bench.newest(m.RoverDriveStatus).limits & DriveLimit.SATURATED


def test_servo_pulses_stand_where_ardurover_has_them() -> None:
    bench = Bench()
    bench.drive(Axes(steering=1.0))
    servos = bench.newest(m.ServoOutputRaw)
    assert (servos.servo1_raw, servos.servo2_raw, servos.servo3_raw) == (1900, 0, 1100)


def test_drive_info_on_request() -> None:
    bench = Bench()
    bench.command(Command.REQUEST_MESSAGE, m.RoverDriveInfo.id)
    info = bench.newest(m.RoverDriveInfo)
    assert (info.drive_type, info.manual_timeout_ms, info.motor_count) == (DriveType.SKID, 450, 2)
    assert (info.throttle_axis, info.steering_axis, info.throttle_neutral) == (0, 3, 0)


def test_time_boot_ms_wraps_after_49_days() -> None:
    bench = Bench(now=0.0)
    bench.readings = EVERYTHING
    bench.now = 2**32 / 1000 + 5.0
    bench._next_cycle = bench.now
    bench.wait(2.0)
    assert bench.newest(m.RoverDriveStatus).time_boot_ms < 10_000


def radio(bench: Bench, free: int) -> None:
    report = m.RadioStatus(0, 0, free, 0, 0, 0, 0)
    bench.say(report, 51, introduced=False, address=bench.station.address)


def with_radio(bench: Bench, free: int, seconds: int) -> dict[type[m.Message], float]:
    """Its rates while the radio reports each second."""
    total = dict.fromkeys(RATES, 0.0)
    for _ in range(seconds):
        radio(bench, free)
        total = {kind: total[kind] + count / seconds for kind, count in counts(bench, 1.0).items()}
    return total


def test_a_full_radio_halves_the_rates_and_an_empty_one_restores() -> None:
    bench = equipped()
    radio(bench, free=10)
    slow = with_radio(bench, 60, 10)
    assert slow[m.Attitude] == pytest.approx(2, abs=0.2)
    assert slow[m.Heartbeat] == pytest.approx(1, abs=0.11)
    assert slow[m.RoverDriveStatus] == pytest.approx(5, abs=0.2)
    radio(bench, free=100)
    bench.wait(1.0)
    assert with_radio(bench, 100, 10)[m.Attitude] == pytest.approx(4, abs=0.2)


def test_a_radio_that_is_gone_slows_nothing_down() -> None:
    bench = equipped()
    for _ in range(3):
        radio(bench, free=10)
    assert with_radio(bench, 60, 4)[m.Attitude] < 1
    bench.wait(6.0)
    assert counts(bench, 10.0)[m.Attitude] == pytest.approx(4, abs=0.2)


def test_links_are_told_and_their_trouble_is_said_once() -> None:
    bench = Bench()
    bench.stick(AHEAD, system=OTHER)
    report = LinkReport(
        "udpout:1", index=3, peers=1, frames=7, crc_errors=2, dialect_mismatch=("HEARTBEAT",), own_id=True
    )
    for _ in range(5):
        bench.rover.observe([report], bench.now)
        bench.wait(1.0)
    links = bench.all(m.RoverLinkStatus)
    assert len(links) == 5
    assert (links[0].link_id, links[0].frames_ok, links[0].crc_errors, links[0].not_in_control) == (3, 7, 2, 1)
    assert sum("Dialect mismatch" in text for text in bench.texts) == 1
    assert said(bench, "Another system on udpout:1 uses our ids 1/1")
    assert sum("our ids" in text for text in bench.texts) == 1


WILD = st.one_of(st.none(), st.floats(), st.sampled_from([math.nan, math.inf, -math.inf, 1e300, -1e300, 0.0]))


NO_NUMBERS = ("wheel_speeds", "ranges", "computer", "configured", "faults")


@settings(max_examples=examples(60))
@given(st.fixed_dictionaries({field.name: WILD for field in fields(Readings) if field.name not in NO_NUMBERS}))
def test_no_reading_breaks_a_message(values: dict[str, float]) -> None:
    """The bench encodes every message that leaves."""
    bench = Bench(CRASH_ANGLE=0, FS_CRASH_CHECK=0)  # some of them are tilted or blocked
    bench.readings = Readings(**values)  # type: ignore[arg-type]
    bench.drive()
    bench.wait(2.0, AHEAD)
    assert bench.turning


def test_the_origin_is_told_when_it_is_known() -> None:
    bench = Bench()
    bench.wait(1.0)
    assert not bench.all(m.GpsGlobalOrigin)
    bench.readings = EVERYTHING
    bench.wait(1.0)
    (origin,) = bench.all(m.GpsGlobalOrigin)
    assert (origin.latitude, origin.longitude) == pytest.approx((481_000_000, 115_000_000), abs=200)
    assert origin.altitude == 500_000
