from __future__ import annotations

from typing import Generic, TypeVar

import pytest

from vehicle.readings import NO_READINGS, ComputerReadings, Readings, SensorFault
from vehicle.sensors import Sensors
from vehicle.sensors.gps import GpsReading, GpsSettings
from vehicle.sensors.gpsd import GpsFix, GpsSky
from vehicle.sensors.power import PowerReading, PowerSettings
from vehicle.sensors.suite import SensorSettings, SensorSources, SensorSuite, open_sensors

T = TypeVar("T")


class Given(Generic[T]):
    """A source with a fixed value."""

    def __init__(self, value: T | None, fault: str | None = None) -> None:
        self.fault = fault
        self.closed = False
        self.value = value

    def latest(self, now: float) -> T | None:
        return self.value

    def close(self) -> None:
        self.closed = True
        if self.fault:
            raise OSError(self.fault)


def test_everything_becomes_one_reading() -> None:
    computer = ComputerReadings(temperature=50.0)
    suite: Sensors = SensorSuite(
        SensorSources(
            battery=Given(PowerReading(12.1, 1.5)),
            gps=Given(GpsReading(GpsFix(3, 1.0, 2.0, 3.0, 0.4, 0.5), GpsSky(9, 0.8))),
            encoders=Given((0.4, 0.6)),
            computer=Given(computer),
        )
    )
    assert suite.read(0.0) == Readings(
        battery_voltage=12.1,
        battery_current=1.5,
        gps_fix=3,
        latitude=1.0,
        longitude=2.0,
        altitude=3.0,
        velocity_north=0.4,
        velocity_east=0.5,
        gps_satellites=9,
        gps_hdop=0.8,
        wheel_speeds=(0.4, 0.6),
        speed=0.5,
        computer=computer,
        configured=("battery", "gps", "encoders", "computer"),
    )


def test_nothing_there_and_nothing_known_is_nothing() -> None:
    assert SensorSuite(SensorSources()).read(0.0) == NO_READINGS
    nothing = SensorSuite(SensorSources(Given(None), Given(None), Given(None), Given(None)))
    assert nothing.read(0.0) == Readings(configured=("battery", "gps", "encoders", "computer"))


def test_faults_are_listed_and_every_sensor_is_closed() -> None:
    battery, gps = Given[PowerReading](None, "no chip"), Given[GpsReading](None)
    suite = SensorSuite(SensorSources(battery=battery, gps=gps))
    assert suite.read(0.0).faults == (SensorFault("battery", "no chip"),)
    with pytest.raises(OSError, match="no chip"):
        suite.close()
    assert battery.closed
    assert gps.closed


def test_a_sensor_that_says_nothing_is_a_fault_after_a_while() -> None:
    gps = Given[GpsReading](None)
    suite = SensorSuite(SensorSources(gps=gps))
    assert suite.read(100.0).faults == suite.read(105.0).faults == ()
    assert suite.read(105.1).faults == (SensorFault("gps", "no data for 5 s"),)
    gps.value = GpsReading(GpsFix(1), GpsSky())
    assert suite.read(106.0).faults == ()
    gps.value = None
    assert suite.read(111.0).faults == ()
    assert suite.read(111.1).faults == (SensorFault("gps", "no data for 5 s"),)


async def test_missing_sensors_do_not_keep_the_rover_from_starting() -> None:
    suite = open_sensors(SensorSettings(battery=PowerSettings("ina219", bus=99), gps=GpsSettings(port=1)))
    try:
        readings = suite.read(0.0)
        assert readings.battery_voltage is None
        assert readings.gps_fix is None
    finally:
        suite.close()
