"""Snapshot of everything the screen shows: built by the station at 2 to 10 Hz, read by the UI.

Units are SI without suffix (m, s, m/s, rad, V); fractions are 0..1 or -1..1; None means "not known".
"""

from __future__ import annotations

from enum import Enum

import msgspec

from groundstation.snapshot.agents import ProposalView
from groundstation.snapshot.drive import HealthLine, KeyToMotor, MissionProgress, StopBound
from groundstation.snapshot.lease import LeaseView
from groundstation.snapshot.log_origin import LogOrigin
from groundstation.snapshot.signing import SigningView


class EmergencyProgress(Enum):
    """How far our request for an emergency stop is, as long as the vehicle itself does not report one."""

    SENT = "sent"
    """Waiting for the first acknowledgement."""
    UNANSWERED = "unanswered"
    """Not acknowledged in time; it is still repeated."""
    REFUSED = "refused"
    ACCEPTED = "accepted"
    """Acknowledged. Whether the motors are off is for the HEARTBEAT to report."""


class OutputView(msgspec.Struct, frozen=True, kw_only=True):
    """One motor output."""

    name: str
    """What it drives, e.g. "left wheel", "steering servo"; its number where that is not known, e.g. "servo 1"."""
    value: float | None
    """-1..1; None: what its pulse means is not known."""


class VehicleView(msgspec.Struct, frozen=True, kw_only=True):
    """The selected vehicle."""

    system: int
    name: str
    """e.g. "Rover 1", "ArduPilot rover 1"."""
    autopilot: int
    mode: str
    armed: bool
    drivable: bool = True
    """The mode is one in which demands drive, such as MANUAL."""
    drives_itself: bool = False
    """Armed in an autonomous mode: the vehicle, or a computer on board, decides where it goes."""
    undriven: str = ""
    """Why this kind of vehicle is only shown and never driven, in one line; "" if it is driven."""
    may_fall: bool = False
    """Armed and, as far as is known, in the air: the emergency stop asks first."""
    flies: bool = False
    """Keys fly it: four axes, and its neutral hovers."""
    keys_mode: str = "MANUAL"
    """The mode to which the key of MANUAL changes."""
    altitude: float | None = None
    """Above home, m."""
    climb: float | None = None
    """m/s."""
    take_off: float | None = None
    """m above the ground to which the key for it takes off; None: it does not fly."""
    altitude_fence: float | None = None
    """m above home that its own fence allows; None: there is none, or it is not known."""
    speed_over_ground: float | None = None
    """m/s, in any direction."""
    drift: float | None = None
    """m/s with which it is carried away while the sticks are at rest; None: it is not, or that cannot be told."""
    battery_left: float | None = None
    """s until the battery is empty, at the rate at which it was used; None: not known."""
    full_speed: float | None = None
    """m/s that full deflection asks for, of what flies; as the next two."""
    full_turn: float | None = None
    """deg/s."""
    full_climb: float | None = None
    """m/s."""
    stop_question: float | None = None
    """s left to press the emergency stop once more, which cuts the motors of a vehicle in the air; None: not asked."""
    status: int
    """MAV_STATE."""
    alive: bool
    """A message arrived within the heartbeat timeout."""
    silence: float
    """Seconds since the last message."""
    driver: int | None = None
    """System id of the ground station in control, 0 for none; None if the vehicle sends no CONTROL_STATUS."""
    in_control: bool = False
    """We are in control; without CONTROL_STATUS: the vehicle accepted arming or a control request from us."""
    duplicate_gcs: bool = False
    """The ground station in control is another program with our system id."""
    control_wait: float | None = None
    """Seconds for which the station in control may still answer our request; None without a request."""
    emergency_stop: bool = False
    """The vehicle reports an emergency stop, or we have requested one."""
    emergency_progress: EmergencyProgress | None = None
    """Our request, while the vehicle does not report an emergency stop itself; else None."""
    stop_doubt: str = ""
    """Which sender of its id does not report that our emergency stop is done, in words."""
    duplicates: str = ""
    """Senders that use its id and are several vehicles, in words."""
    position: tuple[float, float] | None = None
    """North, east of the origin, m."""
    home: tuple[float, float] | None = None
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
    """Throttle and steering that the vehicle reports as obeyed, -1..1."""
    outputs: tuple[OutputView, ...] = ()
    """Motor outputs that are known."""
    limits: tuple[str, ...] = ()
    """Why outputs differ from the demand: "slew", "neutral first" ..."""
    slowed: tuple[float, str] | None = None
    """m/s that the vehicle allows itself now, and why, in two words; None while its demand is within that."""
    nearest: tuple[float, float] | None = None
    """The nearest obstacle: bearing clockwise from the nose, rad, and distance, m; None if none is reported."""
    obstacles: tuple[tuple[float, float], ...] = ()
    """All that it reports, each like `nearest`."""
    command_age: float | None = None
    """Age of the newest demand that the vehicle has taken, s; from some age on it is not obeyed any more."""
    command_age_estimated: bool = False
    """Not reported by the vehicle: time since the newest demand was sent, and half a round trip."""
    speed_demand: float | None = None
    """Speed that the obeyed demand requests, m/s; None where the top speed is not known."""
    key_to_motor: KeyToMotor = KeyToMotor()
    stops: tuple[StopBound, ...] = ()
    """What stops the vehicle without us, most important first."""
    health: tuple[HealthLine, ...] = ()
    mission: MissionProgress | None = None
    """None without a mission."""
    latency: float | None = None
    """Newest key-to-motor latency: from sending a changed demand to the report that it is applied; s."""
    failsafes: tuple[str, ...] = ()
    """Names of the active failsafes, e.g. "gcs loss"."""
    breach: str = ""
    """That a vehicle without our failsafes is outside its fence, e.g. "outside the fence"; "" if not, or not known."""
    failsafe_in: float | None = None
    """Seconds to the next failsafe action."""
    link_loss_action: str | None = None
    """What the vehicle does when it loses us, e.g. "it stops by itself"; None: not known."""
    prearm: bool | None = None
    """The pre-arm checks are passed (SYS_STATUS); None if the vehicle does not report that."""
    prearm_reason: str = ""
    """The newest "PreArm: ..." text while they are not passed."""
    refusal: str | None = None
    """The last refusal and its reason, e.g. "arm denied: PreArm: battery low". Cleared by the next acceptance, when the
    pre-arm checks are passed, and with time."""
    obeys: str | None = None
    """A foreign vehicle obeys another ground station only, by its settings: which one, and what to do."""
    warnings: tuple[str, ...] = ()
    """Why a foreign vehicle may ignore us, and its settings that would let it drive on."""

    @property
    def obeys_keys(self) -> bool:
        """Its mode is the one for keys: MANUAL, or any that holds the altitude of what flies."""
        return self.drivable if self.flies else self.mode == self.keys_mode


class HandoverNotice(msgspec.Struct, frozen=True):
    """Another ground station asks for control of a vehicle that we control."""

    station: int
    """Its system id."""
    vehicle: str
    """Name of the vehicle."""
    left: float
    """Seconds to answer; then control stays with us."""


class OperatorView(msgspec.Struct, frozen=True, kw_only=True):
    """The operator's session."""

    style: str = "hold"
    reports_releases: bool = False
    """The terminal reports key releases; else timers end a key press."""
    stop_bound: float = 0.0
    """The longest time for which a demand is sent after the key is released, s, at present.

    0 if releases are reported, inf if driving goes on until the next key (latch, step)."""
    held: tuple[str, ...] = ()
    """Drive keys that count as held."""
    overrides: bool = False
    """The key is held that overrides the limits before obstacles."""
    held_over: bool = False
    """A drive key that repeats from before keys drove is ignored: it must be released first."""
    throttle: float = 0.0
    """Demand that is being sent, -1..1."""
    steering: float = 0.0
    side: float = 0.0
    """To the right; of what flies, as climb."""
    climb: float = 0.0
    throttle_limit: float = 1.0
    steering_limit: float = 1.0
    gate_open: bool = False
    gate_reason: str = ""
    """Why keys do not drive now."""
    ignored: str = ""
    """Why the drive key that is held, or was until just now, does not count; it must be pressed again."""
    sending: bool = False
    """MANUAL_CONTROL is being sent."""
    rate: float = 0.0
    """MANUAL_CONTROL frames per second over the last second."""

    @property
    def moves(self) -> bool:
        """The demand is not neutral."""
        return bool(self.throttle or self.steering or self.side or self.climb)


class LinkView(msgspec.Struct, frozen=True, kw_only=True):
    """One link."""

    name: str
    loss: float | None = None
    """Lost fraction of the vehicle's frames over the last 5 s."""
    round_trip: float | None = None
    """To the selected vehicle over this link."""
    age: float | None = None
    """How old the newest news of the selected vehicle on it is, s: how late it came, and how long ago."""
    counts: bool = False
    """Of the links to the selected vehicle the one that counts: commands and state take it first."""
    rate: float = 0.0
    """Frames received per second."""
    bytes_per_second: float = 0.0
    frames: int = 0
    """Received since the link opened, like the next three."""
    bytes_received: int = 0
    crc_errors: int = 0
    dropped: int = 0
    """Messages that could not be sent: no room, or the other end refused them."""
    systems: tuple[int, ...] = ()
    """System ids heard, of ground stations too."""
    watch_only: bool = False
    """Nothing is ever sent on it."""
    problem: str | None = None
    """e.g. "messages arrive with another dialect's checksum: HEARTBEAT"."""


class LogLine(msgspec.Struct, frozen=True, kw_only=True):
    """A line of the message log."""

    time: float
    """Wall clock, s since the epoch."""
    severity: int
    """MAV_SEVERITY."""
    label: str
    """"vehicle", "ack", "state", "you" (the operator) or "station"."""
    text: str
    count: int = 1
    """How often the line occurred in a row."""
    number: int = 0
    """Counts the lines of a session from 1. A line that occurs again keeps its number."""
    first: float | None = None
    """Wall clock of its first time, s since the epoch; None: as `time`."""
    origin: LogOrigin | None = None
    """None: this ground station and its operator."""


class ReplayStatus(msgspec.Struct, frozen=True, kw_only=True):
    """The log that is shown in place of links."""

    file: str
    """Name without its folder."""
    wall: float
    """By the recorded clock, s since 1970."""
    position: float
    """s since its start."""
    duration: float
    playing: bool = False
    backwards: bool = False
    speed: float = 1.0
    seeks: int = 0
    """Counts the moves in it: what was received before one is void."""
    refused: int = 0
    """Counts the requests that would have sent something."""
    indexed: float = 1.0
    """0..1"""


class RecordingView(msgspec.Struct, frozen=True, kw_only=True):
    """The recording of this session."""

    path: str = ""
    """The file that is being written; "" while there is none."""
    seconds: float = 0.0
    """Time since it was opened."""
    size: int = 0
    """Its bytes."""
    problem: str = ""
    """Why nothing is recorded, or was until just now."""


class Snapshot(msgspec.Struct, frozen=True, kw_only=True, tag=True):
    """Everything the screen shows."""

    number: int = 0
    """Counted from 1 by the process that sends it; 0: nothing was sent yet."""
    uptime: float = 0.0
    endpoints: tuple[str, ...] = ()
    addresses: tuple[str, ...] = ()
    """IPv4 addresses of this machine without loopback, that of the default route first."""
    waiting: str | None = None
    """What the station waits for while there is no vehicle, in one line."""
    vehicle: VehicleView | None = None
    vehicles: tuple[int, ...] = ()
    """System ids of all vehicles, in rising order; the selected one is among them."""
    not_shown: int = 0
    """Further vehicles that are heard, for which there is no place."""
    also_armed: tuple[int, ...] = ()
    """System ids of the other vehicles that report armed."""
    left_armed: tuple[str, ...] = ()
    """One line for each vehicle that this station armed and would leave armed if it ended now."""
    end_armed: tuple[str, ...] = ()
    """Those of these lines that are about simulators of this station, which end with it."""
    id_conflict: str | None = None
    """Another ground station that uses our system id, as a text for the driver."""
    free_id: int = 254
    """System id that no ground station and no vehicle that is heard uses, for --system."""
    blind_stop: str = ""
    """What is known of a stop that goes to vehicles that are not heard; "" while none does."""
    handover: HandoverNotice | None = None
    """A request of another ground station that waits for the operator's answer."""
    operator: OperatorView = OperatorView()
    lease: LeaseView = LeaseView()
    proposal: ProposalView | None = None
    """Of an agent; None: none waits or runs."""
    links: tuple[LinkView, ...] = ()
    signing: SigningView | None = None
    """Of the selected vehicle; without one, of the system whose frames are refused. None: there is nothing to tell."""
    texts: tuple[LogLine, ...] = ()
    """The newest lines of the log, oldest first, without changes of state and what the operator did."""
    faults: int = 0
    """Links of the chain from the finger to the wheel that stop the operator (groundstation/doctor)."""
    transfers: float | None = None
    """How far the downloads and uploads under way are, 0..1; None without one."""
    recording: RecordingView | None = None
    """None before the first vehicle, and if nothing is to be recorded."""
    simulator: str | None = None
    """State of the simulator that we started, e.g. "running", "ended with code 1: ..."; None without one."""
    replay: ReplayStatus | None = None
    """None: vehicles are heard on links."""
    rests: bool = False
    """The station rests: REST_LEASE_TIMEOUT (groundstation/intents/session.py) is enough for renewals of the lease."""


class StationOutage(msgspec.Struct, frozen=True, tag=True):
    """From the watchdog: the station process has ended or does not respond, and what follows from that."""

    text: str = ""
    """One line for the user; empty: the station responds again."""
    ended: bool = False
    """The process has ended, it does not only stand still."""
