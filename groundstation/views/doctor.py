"""View of the Setup screen: the chain from the finger to the wheel, the pre-arm checks, and a motor test."""

from __future__ import annotations

import msgspec

from groundstation.views.base import View, ViewRequest
from groundstation.views.requests import RequestLine
from link.runtime.diagnosis import Health


class ParamFix(msgspec.Struct, frozen=True):
    """A change of one parameter that is proposed."""

    name: str
    before: float
    value: float


class ChainFinding(msgspec.Struct, frozen=True):
    """What one row of the chain found, why, and what to do."""

    health: Health
    evidence: str
    """What is known, in one line."""
    advice: str = ""
    """What to do."""
    action: str = ""
    """Id of an operator action (groundstation/actions.py) or of the screen that helps; "" for none."""
    fix: ParamFix | None = None


class DoctorRow(ChainFinding, frozen=True, kw_only=True):
    """One link of the chain."""

    id: str
    title: str


class SensorRow(msgspec.Struct, frozen=True):
    """A subsystem of SYS_STATUS."""

    name: str
    health: Health
    """UNKNOWN: present, but not enabled."""


class CheckText(msgspec.Struct, frozen=True):
    """Why the vehicle would refuse to arm, in its own words."""

    text: str
    advice: str
    """What to do; "" for a text that is not in the table."""
    age: float
    """s since the vehicle has said it, whole."""


class MotorRow(msgspec.Struct, frozen=True):
    """A motor that can be tested."""

    number: int
    """The key that turns it, from 1."""
    name: str
    output: str
    """Where it is connected, as the vehicle says, e.g. "SERVO1 73"."""
    value: float | None
    """-1..1 as reported; None: not known."""
    tested: bool = False
    """It was turned in this session."""
    reversal: ParamFix | None = None
    """The change that lets it turn the other way; None where that is not known."""


class CalibrationRow(msgspec.Struct, frozen=True):
    """A kind of calibration."""

    kind: str
    """Name in the command line, e.g. "compass"."""
    title: str
    health: Health
    state: str
    """In words."""


STICKS = "sticks"
"""Kind of calibration that has no command: the station watches RC_CHANNELS."""


class StickRow(msgspec.Struct, frozen=True):
    """An RC channel that is calibrated, us."""

    channel: int
    low: int
    high: int
    now: int
    moved: bool
    """Its travel is long enough to count."""

    @property
    def pulses(self) -> tuple[int, int, int]:
        """The lowest, the highest and the newest."""
        return self.low, self.high, self.now


class MotorTestView(msgspec.Struct, frozen=True):
    """The motor test under way, or how the last one ended."""

    motor: int
    """Number of the MotorRow; 0: none."""
    text: str
    turning: bool


class TerminalFacts(msgspec.Struct, frozen=True):
    """What the screen knows of its terminal."""

    round_trip: float | None = None
    """s from a ping to its answer, in steps of 5 ms; None: no answer yet."""
    silent: bool = False
    """Pings are not answered any more."""


class DoctorRequest(ViewRequest, frozen=True):
    """The chain of the selected vehicle."""

    terminal: TerminalFacts | None = None
    """None: there is no screen."""
    station: int = 0
    """System id of the ground station that will drive; 0: this one."""


class DoctorView(View, frozen=True, kw_only=True):
    """Everything that the Setup screen shows. Ages are whole seconds, so that an unchanged view is not sent again."""

    system: int = 0
    """System id of the vehicle; 0: there is none."""
    name: str = ""
    armed: bool = False
    rows: tuple[DoctorRow, ...]
    sensors: tuple[SensorRow, ...] = ()
    texts: tuple[CheckText, ...] = ()
    checked: RequestLine | None = None
    """The newest request for the pre-arm checks."""
    checked_ago: float | None = None
    """s since it was made."""
    motors: tuple[MotorRow, ...] = ()
    motor_limit: float = 0.3
    """Largest throttle of a motor test, 0..1."""
    test: MotorTestView | None = None
    calibrations: tuple[CalibrationRow, ...] = ()
    calibration: str = ""
    """What the operator has to do for the calibration that runs, or how it ended."""
    waits_for_position: bool = False
    """The calibration of the accelerometers waits until the operator has laid the vehicle as `calibration` says."""
    calibration_share: float | None = None
    """Progress of the compass that is the last, 0..1; None while none measures."""
    compass_ready: bool = False
    """The compasses have results that wait to be written."""
    sticks: tuple[StickRow, ...] | None = None
    """The RC channels while they are calibrated; None: they are not."""
    stick_changes: tuple[ParamFix, ...] = ()
    """What the channels that were moved would change."""
    sticks_unread: tuple[str, ...] = ()
    """Parameters of these channels whose present value is not known yet."""
    facts: tuple[tuple[str, str], ...] = ()
    """What the vehicle is: names and texts."""
    requests: tuple[RequestLine, ...] = ()
    """Requests of this screen: running, then ended, the newest last."""

    @property
    def faults(self) -> tuple[DoctorRow, ...]:
        """What stops the operator, in the order of the chain."""
        return tuple(row for row in self.rows if row.health is Health.FAULT)

    def count(self, health: Health) -> int:
        """Return how many rows have this health."""
        return sum(row.health is health for row in self.rows)
