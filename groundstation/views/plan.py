"""Views of the plans of a vehicle (mission, fence, rally points) and of where it is on the map."""

from __future__ import annotations

from enum import IntEnum

import msgspec

from groundstation.geo import Place
from groundstation.views.base import View, ViewRequest
from groundstation.views.requests import RequestLine

PAGE = 200
"""Items of one page: 8 kB."""

MAX_ITEMS = 3000
"""Items of a plan that the screen edits: more do not fit into one packet of the pipe (ipc.MAX_PACKET)."""


class PlanKind(IntEnum):
    """MAV_MISSION_TYPE."""

    MISSION = 0
    FENCE = 1
    RALLY = 2


class PlanItem(msgspec.Struct, frozen=True, array_like=True):
    """One item, without its number. Home is not an item, and DO_JUMP names its target by the index from 0."""

    command: int
    """MAV_CMD."""
    frame: int
    """MAV_FRAME."""
    params: tuple[float, float, float, float]
    """Parameters 1..4; NaN: the vehicle's default."""
    x: int
    """Latitude in 1e-7 degrees, or north in 1e-4 m, by frame."""
    y: int
    z: float
    """Altitude, m."""
    autocontinue: bool = True


class PlanSummary(msgspec.Struct, frozen=True):
    """What the station knows of one plan of the vehicle."""

    version: int = 0
    """Rises with each plan that was downloaded or accepted; 0: none was."""
    count: int = 0
    changed: bool = False
    """The vehicle reports another plan than this one: somebody else has changed it."""


class PlanMode(msgspec.Struct, frozen=True, array_like=True):
    """A mode that can be chosen."""

    name: str
    moves: bool
    """The vehicle may move by itself in it."""


class Neighbour(msgspec.Struct, frozen=True, array_like=True):
    """Another vehicle."""

    system: int
    place: Place


class PlanRequest(ViewRequest, frozen=True):
    """The plans and the place of the selected vehicle."""


class PlanView(View, frozen=True, kw_only=True):
    """The plans and the place of the selected vehicle, rounded to what a map can show."""

    system: int
    name: str
    autopilot: int
    first: int = 0
    """Number of the first mission item: 1 on ArduPilot, which keeps home as item 0."""
    plans: tuple[PlanSummary, PlanSummary, PlanSummary] = (PlanSummary(), PlanSummary(), PlanSummary())
    """By PlanKind."""
    current: int | None = None
    """Index of the mission item that AUTO drives to; None: not reported, or there is none."""
    reached: tuple[int, ...] = ()
    """Indices of the mission items that were reached since the mission began."""
    state: int = 0
    """MISSION_STATE: 2 not started, 3 active, 4 paused, 5 complete; 0: not reported."""
    off_line: float | None = None
    """m right of the leg, negative left of it."""
    place: Place | None = None
    home: Place | None = None
    home_altitude: float | None = None
    """m above sea level."""
    speed: float | None = None
    """m/s in AUTO, by the vehicle's parameters; None: not read."""
    charge: float | None = None
    """Charge of the battery, 0..1."""
    charge_rate: float | None = None
    """Share of the charge that is used in a second of driving; None: too little was used to tell."""
    neighbours: tuple[Neighbour, ...] = ()
    modes: tuple[PlanMode, ...] = ()
    running: tuple[RequestLine, ...] = ()
    """Requests for plans that run."""
    ended: tuple[RequestLine, ...] = ()
    """The last ones that have ended, oldest first."""


class PlanPageRequest(ViewRequest, frozen=True):
    """Items of one plan of the selected vehicle, if it is `system`."""

    system: int
    kind: int
    version: int
    first: int


class PlanPage(View, frozen=True):
    """Items of one plan, from `first` on; at most PAGE of them."""

    system: int
    kind: int
    version: int
    count: int
    first: int
    items: tuple[PlanItem, ...]


class PlanTrackRequest(ViewRequest, frozen=True):
    """Where the selected vehicle has been."""


class PlanTrackView(View, frozen=True):
    """Where the selected vehicle has been: m north and east of `origin`, oldest first, thinned to 500 points."""

    system: int
    origin: Place | None
    points: tuple[tuple[float, float], ...]


class PlanDocument(msgspec.Struct, frozen=True):
    """The plans of a file, on the pipe to the process that reads and writes it."""

    plans: tuple[tuple[PlanItem, ...], tuple[PlanItem, ...], tuple[PlanItem, ...]]
    """By PlanKind."""
    home: Place | None = None
    home_altitude: float = 0.0
