"""SensorSuite: all sensors of a real rover as one `Sensors`; a failing sensor does not affect the others."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import msgspec

from vehicle.motors.settings import reject_duplicates
from vehicle.readings import ComputerReadings, Readings, SensorFault
from vehicle.safety.battery import SENSOR_TIMEOUT
from vehicle.sensors.encoders import Encoders, EncoderSettings
from vehicle.sensors.gps import GpsdClient, GpsReading, GpsSettings
from vehicle.sensors.latest import SensorSource
from vehicle.sensors.pi_health import MAX_AGE as HEALTH_AGE
from vehicle.sensors.pi_health import PERIOD as HEALTH_PERIOD
from vehicle.sensors.pi_health import PiHealth
from vehicle.sensors.power import MAX_AGE as POWER_AGE
from vehicle.sensors.power import PERIOD as POWER_PERIOD
from vehicle.sensors.power import PowerMonitor, PowerReading, PowerSettings
from vehicle.sensors.ranging.settings import Lidar, Rangefinder
from vehicle.sensors.ranging.sources import RangeSensor, open_lidar, open_rangefinder
from vehicle.sensors.sampler import Sampler


class SensorSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The installed sensors; a sensor without a table is not installed."""

    battery: PowerSettings | None = None
    gps: GpsSettings | None = None
    encoders: EncoderSettings | None = None
    rangefinders: tuple[Rangefinder, ...] = ()
    """Range sensors that look in one direction, each with a number of its own."""
    lidar: Lidar | None = None
    """A range sensor that looks all around."""
    computer: bool = True
    """Monitor the Raspberry Pi itself."""

    def __post_init__(self) -> None:
        reject_duplicates([f"number {each.number}" for each in self.rangefinders])


@dataclass
class SensorSources:
    """The source of each installed sensor."""

    battery: SensorSource[PowerReading] | None = None
    gps: SensorSource[GpsReading] | None = None
    encoders: SensorSource[tuple[float, ...]] | None = None
    computer: SensorSource[ComputerReadings] | None = None
    ranges: tuple[RangeSensor, ...] = ()

    def present(self) -> dict[str, SensorSource[Any]]:
        """Return the installed sensors by the name that the operator reads."""
        sources: dict[str, SensorSource[Any] | None] = {
            "battery": self.battery, "gps": self.gps, "encoders": self.encoders, "computer": self.computer
        }  # fmt: skip
        sources |= {each.name: each for each in self.ranges}
        return {name: source for name, source in sources.items() if source is not None}


class SensorSuite:
    """Fits `vehicle.sensors.Sensors`."""

    def __init__(self, sources: SensorSources) -> None:
        self._present = sources.present()
        self._ranges = sources.ranges
        self._configured = tuple(self._present)
        self._last_value_at: dict[str, float] = {}
        """Name -> time of the last value, at first that of the first `read`."""

    def read(self, now: float) -> Readings:
        """Return the newest values of all sensors."""
        newest = {name: source.latest(now) for name, source in self._present.items()}
        for name, value in newest.items():
            if value is not None or name not in self._last_value_at:
                self._last_value_at[name] = now
        values: dict[str, Any] = {}
        if (power := newest.get("battery")) is not None:
            values.update(battery_voltage=power.voltage, battery_current=power.current)
        if (position := newest.get("gps")) is not None:
            values.update(_position(position))
        if wheels := newest.get("encoders"):
            values.update(wheel_speeds=wheels, speed=sum(wheels) / len(wheels))
        if self._ranges:
            values["ranges"] = tuple(each.reading for each in self._ranges)
        faults = self._faults(now)
        return Readings(computer=newest.get("computer"), configured=self._configured, faults=faults, **values)

    def _faults(self, now: float) -> tuple[SensorFault, ...]:
        """Return the sensors without new values: with their own fault, or with a timeout."""
        found = [(name, source.fault or self._timeout(name, now)) for name, source in self._present.items()]
        return tuple(SensorFault(name, fault) for name, fault in found if fault is not None)

    def _timeout(self, name: str, now: float) -> str | None:
        return f"no data for {SENSOR_TIMEOUT:g} s" if now - self._last_value_at[name] > SENSOR_TIMEOUT else None

    def close(self) -> None:
        """Close every sensor."""
        with contextlib.ExitStack() as steps:
            for source in self._present.values():
                steps.callback(source.close)


def open_sensors(settings: SensorSettings) -> SensorSuite:
    """Open the sensors of `settings` and start reading them. Call it in a running event loop.

    Sensors that do not respond yet are tried again periodically; only sensors on pins raise MotorError, if there are
    none.
    """
    sources = SensorSources()
    with contextlib.ExitStack() as opened:  # first, because only these raise
        if settings.encoders is not None:
            sources.encoders = Encoders(settings.encoders)
            opened.callback(sources.encoders.close)
        for each in settings.rangefinders:
            sources.ranges += (source := open_rangefinder(each),)
            opened.callback(source.close)
        opened.pop_all()
    if settings.lidar is not None:
        sources.ranges += (open_lidar(settings.lidar),)
    if settings.battery is not None:
        sources.battery = _sampled(PowerMonitor(settings.battery).sample, POWER_PERIOD, POWER_AGE)
    if settings.gps is not None:
        sources.gps = GpsdClient(settings.gps)
    if settings.computer:
        sources.computer = _sampled(PiHealth().sample, HEALTH_PERIOD, HEALTH_AGE)
    return SensorSuite(sources)


def _sampled(sample: Callable[[], Any], period: float, max_age: float) -> Sampler[Any]:
    return Sampler(sample, period=period, max_age=max_age)


def _position(reading: GpsReading) -> dict[str, Any]:
    fix, sky = reading.fix, reading.sky
    return {
        "gps_fix": fix.fix_type,
        "latitude": fix.latitude,
        "longitude": fix.longitude,
        "altitude": fix.altitude,
        "velocity_north": fix.velocity_north,
        "velocity_east": fix.velocity_east,
        "gps_satellites": sky.satellites,
        "gps_hdop": sky.hdop,
    }
