"""What the sensors say, raw, as one value a cycle; reading them is vehicle/sensors' and vehicle/sim's work.

What is believed of them is vehicle/navigation/estimator.py's.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ComputerReadings:
    """How the computer on board is; for ONBOARD_COMPUTER_STATUS and for what follows from a weak supply or heat."""

    temperature: float | None = None
    """Degrees Celsius of the processor."""
    load: float | None = None
    """Processes that want to run, a processor each: 1 is busy, more is too much. Mean of a minute."""
    memory_used: int | None = None
    """bytes"""
    memory_total: int | None = None
    uptime: float | None = None
    """s"""
    under_voltage: bool | None = None
    """The supply is too weak now."""
    throttled: bool | None = None
    """The processor is slowed down now, by heat or by a weak supply."""


@dataclass(frozen=True, slots=True)
class SensorFault:
    """Why a sensor gives nothing."""

    sensor: str
    """As the driver calls it: battery, gps."""
    reason: str
    """One line."""


@dataclass(frozen=True, slots=True)
class Readings:
    """The newest of every sensor; None where there is none. Units are SI; angles in rad, yaw clockwise from north."""

    roll: float | None = None
    pitch: float | None = None
    yaw: float | None = None
    """What the compass says."""
    yaw_rate: float | None = None
    """rad/s, clockwise positive; what the gyro says."""
    velocity_north: float | None = None
    """m/s over ground by GPS."""
    velocity_east: float | None = None
    speed: float | None = None
    """m/s along the nose by wheels, negative backwards."""
    latitude: float | None = None
    """Degrees."""
    longitude: float | None = None
    altitude: float | None = None
    """m above mean sea level."""
    gps_fix: int | None = None
    """GPS_FIX_TYPE: 3 and more is a 3D fix."""
    gps_satellites: int | None = None
    gps_hdop: float | None = None
    battery_voltage: float | None = None
    battery_current: float | None = None
    battery_remaining: float | None = None
    """0..1"""
    wheel_speeds: tuple[float, ...] = ()
    """m/s of each wheel, in motor order."""
    computer: ComputerReadings | None = None
    configured: tuple[str, ...] = ()
    """Sensors that there should be, whether they answer or not, by the name that SensorFault has."""
    faults: tuple[SensorFault, ...] = ()
    """Of the sensors that give nothing now; for the driver to read."""


NO_READINGS = Readings()
