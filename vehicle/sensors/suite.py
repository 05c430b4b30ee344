"""All sensors of a real rover as one `Sensors`: each is asked for its newest value, none can stop the others."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import msgspec

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
from vehicle.sensors.sampler import Sampler


class SensorSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Which sensors there are; a table left out is a sensor that is not there."""

    battery: PowerSettings | None = None
    gps: GpsSettings | None = None
    encoders: EncoderSettings | None = None
    computer: bool = True
    """Watch the Pi itself."""


@dataclass
class SensorSources:
    """What there is; any of them may be somebody else's."""

    battery: SensorSource[PowerReading] | None = None
    gps: SensorSource[GpsReading] | None = None
    encoders: SensorSource[tuple[float, ...]] | None = None
    computer: SensorSource[ComputerReadings] | None = None

    def present(self) -> dict[str, SensorSource[Any]]:
        """Those that there are, by the name that the driver reads."""
        everything: dict[str, SensorSource[Any] | None] = {
            "battery": self.battery, "gps": self.gps, "encoders": self.encoders, "computer": self.computer
        }  # fmt: skip
        return {name: source for name, source in everything.items() if source is not None}


class SensorSuite:
    """Fits `vehicle.sensors.Sensors`."""

    def __init__(self, sources: SensorSources) -> None:
        self._present = sources.present()
        self._configured = tuple(self._present)
        self._heard: dict[str, float] = {}
        """When each gave something last, at first when it was asked first."""

    def read(self, now: float) -> Readings:
        """The newest of everything."""
        newest = {name: source.latest(now) for name, source in self._present.items()}
        for name, value in newest.items():
            if value is not None or name not in self._heard:
                self._heard[name] = now
        values: dict[str, Any] = {}
        if (power := newest.get("battery")) is not None:
            values.update(battery_voltage=power.voltage, battery_current=power.current)
        if (position := newest.get("gps")) is not None:
            values.update(_position(position))
        if wheels := newest.get("encoders"):
            values.update(wheel_speeds=wheels, speed=sum(wheels) / len(wheels))
        faults = self._faults(now)
        return Readings(computer=newest.get("computer"), configured=self._configured, faults=faults, **values)

    def _faults(self, now: float) -> tuple[SensorFault, ...]:
        """Why a sensor gives nothing: what it says itself, or that it says nothing at all."""
        found = [(name, source.fault or self._silence(name, now)) for name, source in self._present.items()]
        return tuple(SensorFault(name, fault) for name, fault in found if fault is not None)

    def _silence(self, name: str, now: float) -> str | None:
        return f"silent for {SENSOR_TIMEOUT:g} s" if now - self._heard[name] > SENSOR_TIMEOUT else None

    def close(self) -> None:
        """Let go of every sensor."""
        with contextlib.ExitStack() as steps:
            for source in self._present.values():
                steps.callback(source.close)


def open_sensors(settings: SensorSettings) -> SensorSuite:
    """The sensors of `settings`, reading already. To be called in a running event loop.

    A sensor that is not there yet is looked for again and again; only encoders raise, MotorError, for want of pins.
    """
    sources = SensorSources()
    if settings.encoders is not None:
        sources.encoders = Encoders(settings.encoders)  # first: it is the only one that raises
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
