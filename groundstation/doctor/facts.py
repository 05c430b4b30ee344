"""DoctorFacts: everything that the rows of the chain judge. Collected by station/doctor/doctor_facts.py."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from groundstation.snapshot import LinkView, OperatorView, VehicleView
from groundstation.views.doctor import TerminalFacts


class SettingFact(msgspec.Struct, frozen=True):
    """A parameter that decides what the vehicle does without us."""

    name: str
    value: float
    warning: str
    """What is wrong with it; "" if nothing is."""


class SensorBits(msgspec.Struct, frozen=True):
    """The three bitmasks of SYS_STATUS (MAV_SYS_STATUS_SENSOR)."""

    present: int
    enabled: int
    health: int


class PreArmText(msgspec.Struct, frozen=True):
    """A reason why the vehicle would refuse to arm."""

    text: str
    """Without "PreArm: "."""
    age: float
    """s"""


class PathFact(msgspec.Struct, frozen=True):
    """One path to the vehicle."""

    link: str
    """Name of its link."""
    local: str
    """Address of this computer from which it leaves."""
    host: str
    """Address of the other end."""


class DoctorFacts(msgspec.Struct, frozen=True, kw_only=True):
    """The known state. A vehicle that was never heard is None."""

    system: int
    """System id of the ground station that drives or will drive."""
    vehicle: VehicleView | None = None
    operator: OperatorView = msgspec.field(default_factory=OperatorView)
    links: tuple[LinkView, ...] = ()
    endpoints: tuple[str, ...] = ()
    paths: tuple[PathFact, ...] = ()
    """To the vehicle, over networks; none of serial ports."""
    id_conflict: str | None = None
    free_id: int = 254
    """System id that nobody who is heard uses."""
    terminal: TerminalFacts | None = None
    """None: there is no screen."""
    firmware: str = ""
    version_1: bool = False
    """The vehicle has sent MAVLink 1 only."""
    rover_dialect: bool = False
    """The vehicle sends the private messages of our dialect."""
    unknown_share: float | None = None
    """Share of the frames whose message is not in our dialect, 0..1."""
    mismatched: tuple[str, ...] = ()
    """Messages that arrive with the checksum of another definition."""
    own_id: bool = False
    """Another program sends with our system and component id."""
    clash: bool = False
    """Two programs send with the ids of the driver."""
    signs: bool = False
    """The vehicle signs its frames, with a key that we do not have."""
    verified: bool = False
    """It signs them with a key of ours."""
    sensors: SensorBits | None = None
    texts: tuple[PreArmText, ...] = ()
    settings: tuple[SettingFact, ...] = ()
    unread: tuple[str, ...] = ()
    """Settings that the vehicle did not report."""
    params: Mapping[str, float] = msgspec.field(default_factory=dict)
    """Further parameters that are known."""
    motors_tested: frozenset[int] = frozenset()
    """Numbers of the motors that were turned in this session."""

    @property
    def another_id(self) -> str:
        """How this program gets an id that nobody else uses, as the end of a remedy."""
        return f"start with --system {self.free_id}"
