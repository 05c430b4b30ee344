"""Range sensors on real lines and simulated pins, from their first bytes to the limits of the rover."""

from __future__ import annotations

import math
import time

import pytest
from gpiozero.pins.mock import MockFactory, MockPin, MockTriggerPin

from dialects.enums import DriveLimit, DriveType
from tests.vehicle.sensors.ranging.frames import Line, ld06_turn, tfmini_frame
from tests.waits import wait_until
from vehicle.params import TABLE, Params
from vehicle.proximity.obstacles import Obstacles
from vehicle.sensors.ranging.serial_ranger import SerialRanger
from vehicle.sensors.ranging.settings import Lidar, Tfmini, Ultrasonic
from vehicle.sensors.ranging.sources import open_lidar
from vehicle.sensors.ranging.tfmini import TfminiParser
from vehicle.sensors.ranging.ultrasonic import UltrasonicSensor
from vehicle.sensors.suite import SensorSettings, open_sensors

AHEAD, BACK = (1.0, 1.0), (-1.0, -1.0)
STILL = (0.0, 0.0)


def distance(sensor: UltrasonicSensor) -> float | None:
    newest = sensor.latest(time.monotonic())
    return None if newest is None else newest[0][0].distance


async def test_a_tfmini_behind_stops_the_rover_backwards() -> None:
    with Line(lambda: tfmini_frame(25)) as line:
        suite = open_sensors(SensorSettings(rangefinders=(Tfmini(2, line.path),), computer=False))
        try:
            obstacles = Obstacles(Params({"RNGFND2_ORIENT": 4}), DriveType.SKID)
            wait_until(lambda: suite.read(time.monotonic()).ranges[0].at is not None)
            now = time.monotonic()
            obstacles.sense(suite.read(now).ranges)
            obstacles.move(STILL, None, None, now, 0.02, armed=True)
            assert obstacles.share(BACK, STILL) == (0.0, DriveLimit.OBSTACLE)
            assert obstacles.share(AHEAD, STILL) == (1.0, 0)
        finally:
            suite.close()


async def test_a_sensor_that_never_measures_is_missed() -> None:
    suite = open_sensors(SensorSettings(rangefinders=(Tfmini(1, "/dev/nowhere"),), computer=False))
    try:
        obstacles = Obstacles(Params({"AVOID_LOST_SPD": 0.0}), DriveType.SKID)
        wait_until(lambda: bool(suite.read(time.monotonic()).faults))
        readings = suite.read(time.monotonic())
        assert "/dev/nowhere" in readings.faults[0].reason
        obstacles.sense(readings.ranges)
        obstacles.move(STILL, None, None, time.monotonic(), 0.02, armed=True)
        assert obstacles.faults == {"RNGFND1": "no data"}
        assert obstacles.share(AHEAD, STILL) == (0.0, DriveLimit.RANGE_SENSOR)
        assert obstacles.share(BACK, STILL) == (1.0, 0)
    finally:
        suite.close()


def test_a_lidar_sees_all_around() -> None:
    with Line(lambda: ld06_turn(lambda angle: 1.5 if 175 < angle < 185 else 4.0), period=0.1) as line:
        source = open_lidar(Lidar(line.path))
        try:
            wait_until(lambda: source.latest(time.monotonic()) is not None)
            nearest = min(source.reading.scan, key=lambda cone: cone.distance or 9.0)
            assert nearest.distance == 1.5
            assert nearest.bearing == pytest.approx(math.pi, abs=0.1)
        finally:
            source.close()


def test_a_line_says_what_is_wrong_and_comes_back() -> None:
    with Line(lambda: b"$GPRMC,nothing of ours\r\n") as line:
        ranger = SerialRanger(line.path, 115_200, TfminiParser())
        with pytest.raises(OSError, match="sends no valid frames: is this its port"):
            ranger.sample()
        line.frame = lambda: b""
        ranger.close()
        with pytest.raises(OSError, match="is silent; check its power and wiring"):
            ranger.sample()
        line.frame = lambda: tfmini_frame(77)
        [cone] = ranger.sample()
        assert cone.distance == 0.77
        ranger.close()


def test_an_hc_sr04_pings_and_names_a_broken_wire() -> None:
    factory = MockFactory()
    echo = factory.pin(6)
    trigger = factory.pin(5, pin_class=MockTriggerPin, echo_pin=echo, echo_time=0.004)
    assert isinstance(trigger, MockTriggerPin)
    assert isinstance(echo, MockPin)
    sensor = UltrasonicSensor(Ultrasonic(1, trigger=5, echo=6), 0.5, pin_factory=factory)
    try:
        wait_until(lambda: distance(sensor) is not None)
        measured = distance(sensor)
        assert measured is not None
        assert 0.6 < measured <= 3.0  # 0.69 m, and more on a machine that is late
        trigger.echo_pin = factory.pin(7)  # the wire of the echo breaks
        wait_until(lambda: sensor.fault is not None)
        assert "no echo pulse" in str(sensor.fault)
        wait_until(lambda: sensor.latest(time.monotonic()) is None)
    finally:
        sensor.close()
        sensor.close()


async def test_a_rangefinder_that_is_not_installed_limits_nothing() -> None:
    """Only rover.toml says what is installed: there is no RNGFND1_TYPE, and the other parameters make no sensor."""
    assert [each.name for each in TABLE if each.name.startswith("RNGFND") and each.name.endswith("_TYPE")] == []
    suite = open_sensors(SensorSettings(computer=False))
    try:
        now = time.monotonic()
        readings = suite.read(now)
        assert (readings.ranges, readings.faults, readings.configured) == ((), (), ())
        obstacles = Obstacles(Params({"RNGFND1_ORIENT": 4, "RNGFND1_MAX": 0.5, "AVOID_LOST_SPD": 0.0}), DriveType.SKID)
        for later in (0.0, 60.0):
            obstacles.sense(suite.read(now + later).ranges)
            obstacles.move(STILL, None, None, now + later, 0.02, armed=True)
            assert obstacles.share(AHEAD, STILL) == obstacles.share(BACK, STILL) == (1.0, 0)
        assert obstacles.faults == {}
    finally:
        suite.close()


def test_two_rangefinders_have_two_numbers() -> None:
    with pytest.raises(ValueError, match="number 1 is used twice"):
        SensorSettings(rangefinders=(Tfmini(1, "/dev/a"), Tfmini(1, "/dev/b")))
