"""State: what a program sees of its vehicle, and StateValues: its values as attributes. SI, angles in degrees."""

from __future__ import annotations

from abc import ABC, abstractmethod

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


class StateValues(ABC):
    """The values of the newest state that programs ask for most."""

    @property
    @abstractmethod
    def state(self) -> State:
        """The newest state; ten come in a second. Raises Disconnected."""

    @property
    def mode(self) -> str:
        """The mode, such as MANUAL."""
        return self.state.mode

    @property
    def armed(self) -> bool:
        """Whether its motors are armed."""
        return self.state.armed

    @property
    def position(self) -> Position | None:
        """Where it is; None without a fix."""
        return self.state.position

    @property
    def heading(self) -> float | None:
        """Degrees clockwise from north, 0 to 360."""
        return self.state.heading

    @property
    def speed(self) -> float | None:
        """m/s over ground."""
        return self.state.speed

    @property
    def battery(self) -> float | None:
        """What is left of the battery, 0 to 1."""
        return self.state.battery
