"""One frozen picture of everything the screen shows; the station makes it at 10 Hz, the UI only reads it.

Units are SI without suffix (m, s, m/s, rad, V); fractions are 0..1 or -1..1; None is "not known".
"""

from __future__ import annotations

import msgspec


class VehicleView(msgspec.Struct, frozen=True, kw_only=True):
    """The vehicle we look at."""

    system: int
    name: str
    """e.g. "Rover 1", "ArduPilot rover 1"."""
    autopilot: int
    mode: str
    armed: bool
    status: int
    """MAV_STATE."""
    alive: bool
    """Something was heard within the heartbeat timeout."""
    silence: float
    """Seconds since anything was heard."""
    driver: int | None = None
    """System id of the ground station in control, 0 for nobody; None where the vehicle does not tell."""
    in_control: bool = False
    """We are the ground station in control (or, where the vehicle does not tell, we armed it or drive it)."""
    emergency_stop: bool = False
    position: tuple[float, float] | None = None
    """North, east of the origin, m."""
    home: tuple[float, float] | None = None
    track: tuple[tuple[float, float], ...] = ()
    """Earlier positions, oldest first, thinned to at most 500."""
    heading: float | None = None
    """Clockwise from north, rad, 0..2 pi."""
    roll: float | None = None
    pitch: float | None = None
    speed: float | None = None
    """Along the nose where known, else over ground; m/s."""
    battery_voltage: float | None = None
    battery_current: float | None = None
    battery_remaining: float | None = None
    """0..1"""
    gps_fix: int | None = None
    """GPS_FIX_TYPE: 3 and more is a 3D fix."""
    gps_satellites: int | None = None
    demand: tuple[float, float] | None = None
    """Throttle and steering that the vehicle says it obeys, -1..1."""
    outputs: tuple[float, ...] = ()
    """What each motor gets, -1..1."""
    limits: tuple[str, ...] = ()
    """Why outputs differ from the demand, as words: "slew", "neutral first" ..."""
    command_age: float | None = None
    """Age of the demand that the motors obey, as the vehicle tells it; s."""
    latency: float | None = None
    """Key to motor: from sending a changed demand to the vehicle's word that it is applied; s, newest."""
    failsafes: tuple[str, ...] = ()
    """Active failsafes as words."""
    failsafe_in: float | None = None
    """Seconds to the next failsafe action."""
    refusal: str | None = None
    """What was refused last and why, e.g. "arm denied: PreArm: battery low". Cleared by the next acceptance."""
    warnings: tuple[str, ...] = ()
    """Settings of a foreign vehicle that would let it drive on."""


class OperatorView(msgspec.Struct, frozen=True, kw_only=True):
    """The operator's side."""

    style: str = "hold"
    reports_releases: bool = False
    """Key releases are reported; else timers end a push."""
    stop_bound: float = 0.0
    """The longest a vehicle gets a demand after the key is let go, s, as it stands now.

    0 where releases are reported, inf where the drive goes on until the next key (latch, step)."""
    held: tuple[str, ...] = ()
    """Keys that count as held."""
    throttle: float = 0.0
    """Demand that is being sent, -1..1."""
    steering: float = 0.0
    throttle_limit: float = 1.0
    steering_limit: float = 1.0
    gate_open: bool = False
    gate_reason: str = ""
    """Why keys do not drive now."""
    sending: bool = False
    """MANUAL_CONTROL is being sent."""
    rate: float = 0.0
    """MANUAL_CONTROL frames per second over the last second."""


class LinkView(msgspec.Struct, frozen=True, kw_only=True):
    """One link."""

    name: str
    loss: float | None = None
    """Lost fraction of the vehicle's frames over the last 5 s."""
    round_trip: float | None = None
    rate: float = 0.0
    """Frames received per second."""
    bytes_per_second: float = 0.0
    crc_errors: int = 0
    problem: str | None = None
    """e.g. "messages arrive with another dialect's checksum: HEARTBEAT"."""


class LogLine(msgspec.Struct, frozen=True, kw_only=True):
    """A line of the message log."""

    time: float
    """Wall clock, s since the epoch."""
    severity: int
    """MAV_SEVERITY."""
    label: str
    """"vehicle", "ack" or "station"."""
    text: str
    count: int = 1
    """How often it came in a row."""


class MessageRate(msgspec.Struct, frozen=True, kw_only=True):
    """One kind of message."""

    name: str
    rate: float
    count: int
    sent: bool = False
    """We send it; else we receive it."""


class Snapshot(msgspec.Struct, frozen=True, kw_only=True, tag=True):
    """Everything the screen shows."""

    number: int = 0
    uptime: float = 0.0
    endpoints: tuple[str, ...] = ()
    waiting: str | None = None
    """What is being waited for while there is no vehicle, in one line."""
    vehicle: VehicleView | None = None
    vehicles: tuple[int, ...] = ()
    """System ids of all vehicles heard."""
    operator: OperatorView = OperatorView()
    links: tuple[LinkView, ...] = ()
    texts: tuple[LogLine, ...] = ()
    """The newest 200, oldest first."""
    messages: tuple[MessageRate, ...] = ()
    simulator: str | None = None
    """State of the simulator we started, e.g. "running", "ended with code 1: ..."; None where we started none."""
