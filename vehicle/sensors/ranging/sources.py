"""The range sensors of rover.toml as sources of readings."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from vehicle.readings import RangeReading, Scan
from vehicle.sensors.latest import SensorSource
from vehicle.sensors.ranging import ld06, tfmini, ultrasonic
from vehicle.sensors.ranging.serial_ranger import SerialRanger
from vehicle.sensors.ranging.settings import Lidar, Rangefinder, Tfmini, Ultrasonic, Vl53l0x, Vl53l1x
from vehicle.sensors.ranging.time_of_flight import TimeOfFlight
from vehicle.sensors.ranging.ultrasonic import UltrasonicSensor
from vehicle.sensors.sampler import Sampler

PERIOD, MAX_AGE = 0.02, 0.5
"""s from one measurement to the begin of the next, which waits for the sensor; and how long one is valid."""

TimedScan = tuple[Scan, float]
"""A scan, and when it was measured."""
Opened = tuple[Scan, SensorSource[TimedScan]]
"""Where a sensor looks, and its source."""


class RangeSensor:
    """One sensor. It always has a reading, so that a sensor that never measures is missed."""

    def __init__(self, name: str, mount: int, opened: Opened) -> None:
        """`mount`: as in RangeReading."""
        unmeasured, self._source = opened
        self.name = name
        self._newest = RangeReading(name, unmeasured, None, mount)

    @property
    def fault(self) -> str | None:
        """Why there is no new scan."""
        return self._source.fault

    def latest(self, now: float) -> RangeReading | None:
        """Return a reading that is recent, or None."""
        newest = self._source.latest(now)
        if newest is None:
            return None
        scan, at = newest
        self._newest = self._newest._replace(scan=scan, at=at)
        return self._newest

    @property
    def reading(self) -> RangeReading:
        """The last reading, however old."""
        return self._newest

    def close(self) -> None:
        """Release the hardware."""
        self._source.close()


def open_rangefinder(settings: Rangefinder) -> RangeSensor:
    """Open one of the rangefinders. Raises MotorError if there are no pins."""
    return RangeSensor(f"RNGFND{settings.number}", settings.number, OPENERS[type(settings)](settings))


def open_lidar(settings: Lidar) -> RangeSensor:
    """Open the lidar."""
    ranger = SerialRanger(settings.port, ld06.BAUD, ld06.Ld06Parser())
    return RangeSensor("PRX1", 0, (ld06.UNMEASURED, _sampled(ranger.sample)))


def _open_ultrasonic(settings: Ultrasonic) -> Opened:
    return ultrasonic.BEAM.scan(None), UltrasonicSensor(settings, MAX_AGE)


def _open_time_of_flight(settings: Vl53l0x | Vl53l1x) -> Opened:
    sensor = TimeOfFlight(settings)
    return sensor.beam.scan(None), _sampled(sensor.sample)


def _open_tfmini(settings: Tfmini) -> Opened:
    ranger = SerialRanger(settings.port, tfmini.BAUD, tfmini.TfminiParser())
    return tfmini.BEAM.scan(None), _sampled(ranger.sample)


def _sampled(sample: Callable[[], Scan]) -> Sampler[TimedScan]:
    return Sampler(lambda: (sample(), time.monotonic()), period=PERIOD, max_age=MAX_AGE)


OPENERS: dict[type, Callable[[Any], Opened]] = {
    Ultrasonic: _open_ultrasonic,
    Vl53l0x: _open_time_of_flight,
    Vl53l1x: _open_time_of_flight,
    Tfmini: _open_tfmini,
}
"""Settings of a rangefinder -> what opens it."""
