"""The raw sensor readings of one cycle, from vehicle/sensors or vehicle/sim.

The estimator (vehicle/navigation/estimator.py) decides which of them it uses.
"""

from __future__ import annotations

from typing import NamedTuple

import msgspec


class ComputerReadings(msgspec.Struct, frozen=True):
    """State of the companion computer, for ONBOARD_COMPUTER_STATUS and the overheat failsafe."""

    temperature: float | None = None
    """Temperature of the processor in degrees Celsius."""
    load: float | None = None
    """Load average of 1 min divided by the number of cores: 1 is fully busy, more is overloaded."""
    memory_used: int | None = None
    """Bytes."""
    memory_total: int | None = None
    uptime: float | None = None
    """s since the computer booted."""
    under_voltage: bool | None = None
    """The supply voltage is too low now."""
    throttled: bool | None = None
    """The processor is throttled now, because of heat or low voltage."""


class SensorFault(msgspec.Struct, frozen=True):
    """Why a sensor gives no readings."""

    sensor: str
    """Its name: battery, gps."""
    reason: str
    """One line."""


class Cone(NamedTuple):
    """One direction of a range sensor. m and rad, clockwise from the nose."""

    bearing: float
    half_width: float
    distance: float | None
    """To the nearest obstacle; `far` if there is none in range, 0 if it is nearer than the sensor can measure.

    None: not measured."""
    far: float
    """Largest distance that it measures."""
    central: bool = False
    """The distance is from the centre of the rover, else from its outline."""

    @property
    def is_clear(self) -> bool:
        """There is nothing in range."""
        return self.distance is not None and self.distance >= self.far


Scan = tuple[Cone, ...]
"""What one message reports."""


class RangeReading(NamedTuple):
    """The newest scan of a range sensor of this computer."""

    sensor: str
    """Its name in rover.toml."""
    scan: Scan
    """Where it looks; without distances until it has measured."""
    at: float | None
    """When it was measured; None before the first time."""
    mount: int = -1
    """How its directions become those of the rover (vehicle/proximity/mounting.py); -1: they are."""


class Readings(msgspec.Struct, frozen=True):
    """The newest readings of all sensors; None without one. SI units; angles in rad, yaw clockwise from north."""

    roll: float | None = None
    pitch: float | None = None
    yaw: float | None = None
    """Heading of the compass."""
    yaw_rate: float | None = None
    """rad/s of the gyro, clockwise positive."""
    velocity_north: float | None = None
    """m/s over ground, from GPS."""
    velocity_east: float | None = None
    speed: float | None = None
    """m/s forwards, from wheel encoders; negative backwards."""
    latitude: float | None = None
    """Degrees."""
    longitude: float | None = None
    altitude: float | None = None
    """m above mean sea level, from GPS."""
    gps_fix: int | None = None
    """GPS_FIX_TYPE: 3 and above is a 3D fix."""
    gps_satellites: int | None = None
    gps_hdop: float | None = None
    battery_voltage: float | None = None
    battery_current: float | None = None
    battery_remaining: float | None = None
    """0..1"""
    wheel_speeds: tuple[float, ...] = ()
    """m/s of each wheel, in motor order."""
    ranges: tuple[RangeReading, ...] = ()
    """Range sensors, all that are configured."""
    computer: ComputerReadings | None = None
    configured: tuple[str, ...] = ()
    """Names of the configured sensors, whether they respond or not, as in SensorFault."""
    faults: tuple[SensorFault, ...] = ()
    """Faults of the sensors that give no readings now."""


NO_READINGS = Readings()
