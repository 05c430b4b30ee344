"""Views of the vehicles, the links, and who is in control."""

from __future__ import annotations

import msgspec

from groundstation.snapshot.signing import SigningView
from groundstation.views.base import View, ViewRequest


class VehiclesRequest(ViewRequest, frozen=True):
    """All vehicles."""


class ComponentRow(msgspec.Struct, frozen=True):
    """A further component of a vehicle, such as a camera."""

    component: int
    kind: str
    """Its MAV_TYPE in words, e.g. "onboard controller"."""


class VehicleRow(msgspec.Struct, frozen=True, kw_only=True):
    """One vehicle. Ages and distances are rounded to what is drawn, so that an unchanged row is not sent again."""

    system: int
    name: str
    firmware: str = ""
    """Version, e.g. "4.6.1"; empty until AUTOPILOT_VERSION has arrived."""
    mode: str
    armed: bool
    emergency_stop: bool = False
    alive: bool = True
    silence: float
    """Seconds since the last message."""
    state: str = ""
    """MAV_STATE in words."""
    battery_voltage: float | None = None
    battery_remaining: float | None = None
    """0..1"""
    distance: float | None = None
    """m from the selected vehicle; of the selected vehicle itself from its home. None: not known."""
    bearing: float | None = None
    """Degrees clockwise from north, seen from there."""
    has_position: bool = False
    in_control: bool = False
    """This station is in control."""
    driver: int | None = None
    """System id of the ground station in control, 0 for none; None if the vehicle does not report it."""
    signing: str = ""
    """State of signing in a word."""
    components: tuple[ComponentRow, ...] = ()


class VehiclesView(View, frozen=True):
    """All vehicles, by system id."""

    rows: tuple[VehicleRow, ...]
    not_shown: int = 0
    """Further vehicles that are heard, for which there is no place."""


class LinksRequest(ViewRequest, frozen=True):
    """All links."""


class PathRow(msgspec.Struct, frozen=True, kw_only=True):
    """A further address of the selected vehicle on one link. Fields as in LinkRow."""

    address: str
    round_trip: float | None = None
    age: float | None = None


class LinkRow(msgspec.Struct, frozen=True, kw_only=True):
    """One link. Rates are over the last 5 s, counters since the link opened."""

    name: str
    """The endpoint as the user wrote it."""
    index: int = 0
    """Its number, for intents; below 0 while it cannot be opened."""
    watch_only: bool = False
    """Nothing is ever sent on it."""
    retry_in: float | None = None
    """s until the next attempt to open it; None while it is open."""
    peers: tuple[str, ...] = ()
    """Addresses of the first other ends that sent a HEARTBEAT, without one that the endpoint names."""
    peer_count: int = 0
    """Other ends that sent a HEARTBEAT."""
    frames_in: float = 0.0
    """Frames received per second."""
    frames_out: float = 0.0
    bytes_in: float = 0.0
    """Bytes received per second."""
    bytes_out: float = 0.0
    loss: float | None = None
    """Lost fraction of the frames of vehicles; None if none arrived."""
    lost: int = 0
    """Frames of vehicles that were lost."""
    crc_errors: int = 0
    refused: int = 0
    """Peers refused because there was no place."""
    dropped: int = 0
    """Frames that could not be sent."""
    round_trip: float | None = None
    """s, to the selected vehicle."""
    jitter: float | None = None
    """s; smoothed difference between one round trip and the next, on the link that counts."""
    age: float | None = None
    """How old the newest news of the selected vehicle on it is, s; None if it brings none."""
    counts: bool = False
    """Of the links to the selected vehicle the one that counts: commands and state take it first."""
    more: tuple[PathRow, ...] = ()
    """Further addresses of the selected vehicle on the same link."""
    capacity: float | None = None
    """Bytes/s that the line carries in each direction; None where unknown (UDP, TCP)."""
    headroom: float = 1.0
    """Share of the capacity that a telemetry radio allows now."""
    unverified: str = ""
    """What signing has refused on this link, in words; empty if nothing, or if nothing is verified."""
    problem: str | None = None

    @property
    def share(self) -> float | None:
        """Share of the capacity that the busier direction uses; None where the capacity is unknown."""
        return None if not self.capacity else max(self.bytes_in, self.bytes_out) / self.capacity


class LinksView(View, frozen=True):
    """All links, in the order in which they were opened."""

    rows: tuple[LinkRow, ...]


class ControlRequest(ViewRequest, frozen=True):
    """Who is in control of the selected vehicle."""


class Program(msgspec.Struct, frozen=True):
    """A program that controls vehicles: a ground station or a script."""

    system: int
    component: int
    session: int = 0
    """Its random number; 0: it has none."""


class StationRow(msgspec.Struct, frozen=True):
    """A ground station that is heard."""

    system: int
    component: int
    silence: float
    """Seconds since its last HEARTBEAT."""


class ControlView(View, frozen=True, kw_only=True):
    """Who is in control of the selected vehicle, as it reports, and who else is there."""

    vehicle: str
    """Its name; empty without a vehicle."""
    ours: Program
    """This station."""
    in_control: bool = False
    """This station is in control."""
    driver: int | None = None
    """System id of the ground station in control, 0 for none; None if the vehicle does not report it."""
    program: Program | None = None
    """Its program in ROVER_CONTROL; None if the vehicle sends none, or no program is in control."""
    age: float | None = None
    """Seconds since the vehicle reported it."""
    takeover: bool = False
    """A request for control is granted without asking the driver."""
    clash: bool = False
    """Two programs send with the ids of the driver: its demands do not count for the moment."""
    silent: bool = False
    """The driver is silent: another program with its ids may succeed it."""
    waits: float | None = None
    """Seconds for which the driver may still answer our request."""
    stations: tuple[StationRow, ...] = ()
    """Other ground stations, by their ids."""
    signing: SigningView | None = None
    """As in the snapshot."""
    signing_systems: tuple[int, ...] = ()
    """All system ids whose newest frame was signed."""
