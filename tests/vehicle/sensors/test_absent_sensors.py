"""A sensor that the rover should have and that does not answer: who arms, what works, what the driver reads."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from dialects import messages as m
from dialects.enums import Command, Result, Sensor
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, EVERYTHING, Bench, said
from vehicle.readings import NO_READINGS, Readings, SensorFault

FORCE = 21196
NO_CHIP = Readings(configured=("battery",), faults=(SensorFault("battery", "no chip at 0x40"),))
NO_GPSD = Readings(configured=("gps",), faults=(SensorFault("gps", "no gpsd"),))
POWERED = Readings(configured=("battery",), battery_voltage=12.0)


def bench_with(readings: Readings) -> Bench:
    bench = Bench()
    bench.readings = readings
    bench.wait(1.0)
    return bench


@pytest.mark.parametrize("readings", [NO_CHIP, replace(NO_CHIP, faults=())], ids=["it says why", "it says nothing"])
def test_a_battery_sensor_that_never_answered_forbids_to_arm(readings: Readings) -> None:
    bench = bench_with(readings)
    assert bench.arm() is Result.FAILED
    bench.wait(0.1)
    assert said(bench, "PreArm: no data from the battery sensor")
    health = bench.newest(m.SysStatus)
    assert health.onboard_control_sensors_present & Sensor.BATTERY
    assert not health.onboard_control_sensors_health & Sensor.BATTERY
    bench.readings = POWERED
    bench.cycle()
    bench.drive()


def test_one_that_fell_silent_forbids_to_arm_after_5_s() -> None:
    bench = bench_with(POWERED)
    bench.readings = NO_CHIP
    bench.wait(4.9)
    bench.drive()
    bench.command(Command.COMPONENT_ARM_DISARM, 0)
    bench.wait(1.0)
    assert bench.arm() is Result.FAILED


def test_one_that_falls_silent_while_driving_stops_nothing() -> None:
    bench = bench_with(POWERED)
    bench.drive()
    bench.readings = NO_CHIP
    bench.wait(20.0, AHEAD)
    assert bench.throttles == (1.0, 1.0)
    assert said(bench, "battery sensor: no chip at 0x40")


def test_who_knows_better_arms_by_force() -> None:
    bench = bench_with(NO_CHIP)
    assert bench.command(Command.COMPONENT_ARM_DISARM, 1, FORCE) is Result.ACCEPTED


@pytest.mark.parametrize("readings", [NO_READINGS, Readings(configured=("encoders", "computer"))])
def test_a_rover_that_has_no_battery_sensor_arms(readings: Readings) -> None:
    bench = bench_with(readings)
    bench.drive()
    assert not bench.newest(m.SysStatus).onboard_control_sensors_present & Sensor.BATTERY


def test_without_gps_a_rover_drives_but_refuses_position_modes() -> None:
    bench = bench_with(NO_GPSD)
    assert said(bench, "gps sensor: no gpsd")
    health = bench.newest(m.SysStatus)
    assert health.onboard_control_sensors_present & Sensor.GPS
    assert not health.onboard_control_sensors_health & Sensor.GPS
    bench.drive()
    for mode in (Mode.AUTO, Mode.RTL, Mode.SMART_RTL, Mode.LOITER):
        assert bench.set_mode(mode) is Result.FAILED, mode
    bench.wait(0.1, AHEAD)
    assert said(bench, "Mode RTL refused: position is not known")
    assert bench.mode is Mode.MANUAL
    assert bench.turning


def test_without_its_encoders_a_rover_drives() -> None:
    bench = bench_with(Readings(configured=("encoders",), faults=(SensorFault("encoders", "no data for 5 s"),)))
    assert said(bench, "encoders sensor: no data for 5 s")
    bench.drive()
    bench.wait(5.0, AHEAD)
    assert bench.turning, "a speed that nobody measures is not a blocked rover"


def test_a_sensor_that_is_there_says_so() -> None:
    bench = bench_with(replace(EVERYTHING, configured=("battery", "gps")))
    health = bench.newest(m.SysStatus)
    both = Sensor.BATTERY | Sensor.GPS
    assert health.onboard_control_sensors_health & both == both
    bench.drive()
