"""State: what a program sees of its vehicle. SI, angles in degrees."""

from __future__ import annotations

import msgspec


class Position(msgspec.Struct, frozen=True):
    """A place, WGS 84."""

    latitude: float
    """Degrees, -90 to 90."""
    longitude: float
    """Degrees, -180 to 180."""


class State(msgspec.Struct, frozen=True, kw_only=True):
    """The newest state of the vehicle. None: it does not report the value."""

    system: int
    """System id, 1 to 255."""
    name: str
    mode: str
    """Such as MANUAL, HOLD, AUTO."""
    armed: bool
    alive: bool
    """Its heartbeats arrive."""
    silence: float
    """s since its newest heartbeat."""
    driver: int | None = None
    """System id of the ground station in control, 0: none."""
    in_control: bool = False
    """This program is in control."""
    emergency_stop: bool = False
    failsafes: tuple[str, ...] = ()
    ready_to_arm: bool | None = None
    not_ready_reason: str = ""
    position: Position | None = None
    heading: float | None = None
    """Degrees clockwise from north, 0 to 360."""
    roll: float | None = None
    """Degrees, positive to the right."""
    pitch: float | None = None
    """Degrees, positive upwards."""
    speed: float | None = None
    """m/s over ground."""
    voltage: float | None = None
    """V."""
    battery: float | None = None
    """What is left, 0 to 1."""
    gps_fix: int | None = None
    """GPS_FIX_TYPE: 3 and more is a 3D fix."""
    satellites: int | None = None
    throttle: float | None = None
    """Demand that the vehicle applies, -1 to 1."""
    steering: float | None = None
    """Demand that the vehicle applies, -1 to 1, positive to the right."""
