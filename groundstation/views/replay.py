"""View of the Replay screen: the file, the position, the timeline and the events."""

from __future__ import annotations

import msgspec

from groundstation.views.base import View, ViewRequest

MAX_COLUMNS = 400
MAX_ROWS = 100


class ReplayRequest(ViewRequest, frozen=True):
    """The timeline in so many columns, and the events around a row."""

    columns: int = 80
    rows: int = 10
    top: int | None = None
    """Number of the first event; None: the present one stays in sight."""


class ReplayEvent(msgspec.Struct, frozen=True, array_like=True):
    """What happened at one time."""

    time: float
    """s since the start of the log."""
    wall: float
    """By the recorded clock, s since 1970."""
    kind: str
    """A tag of at most five characters."""
    severity: int
    """MAV_SEVERITY."""
    text: str


class ReplaySpan(msgspec.Struct, frozen=True, array_like=True):
    """A mode, or armed, from one time to another, s since the start."""

    start: float
    end: float
    text: str


class ReplaySign(msgspec.Struct, frozen=True, array_like=True):
    """The most severe event of a column of the timeline."""

    column: int
    kind: str
    severity: int
    text: str


class Timeline(msgspec.Struct, frozen=True, kw_only=True):
    """What happened over the whole log; one value a column, None where there is none."""

    modes: tuple[ReplaySpan, ...] = ()
    armed: tuple[ReplaySpan, ...] = ()
    speed: tuple[float | None, ...] = ()
    """Largest speed, m/s."""
    demand: tuple[float | None, ...] = ()
    """Largest axis of the driver's demand, 0..1."""
    lost: tuple[float | None, ...] = ()
    """Packet numbers that are missing."""
    damage: tuple[float | None, ...] = ()
    """Bytes that belong to no valid record."""
    signs: tuple[ReplaySign, ...] = ()


class ReplayView(View, frozen=True, kw_only=True):
    """The state of a replay."""

    file: str = ""
    """Name of the file without its folder."""
    path: str = ""
    """Its whole path."""
    size: int = 0
    """Bytes."""
    began: float = 0.0
    """Recorded clock of the first record, s since 1970."""
    ended: float = 0.0
    messages: int = 0
    position: float = 0.0
    """s since the start."""
    wall: float = 0.0
    duration: float = 0.0
    """s; grows with the index."""
    playing: bool = False
    backwards: bool = False
    speed: float = 1.0
    marks: tuple[float | None, float | None] = (None, None)
    """A and B, s since the start."""
    cut: tuple[float | None, float | None] = (None, None)
    """The marks by the recorded clock, s since that of the first record: as exports take them."""
    loop: bool = False
    indexed: float = 1.0
    """0..1"""
    checked: float = 1.0
    """Checksums that are checked, 0..1."""
    damaged: int = 0
    """Bytes that belong to no valid record, so far."""
    tail: int = 0
    """Bytes at the end that are not a whole record."""
    lost: int = 0
    """Packet numbers that are missing, so far."""
    stations: tuple[int, ...] = ()
    """System ids of the ground stations in the log."""
    vehicles: tuple[int, ...] = ()
    timeline: Timeline = Timeline()
    events: tuple[ReplayEvent, ...] = ()
    """Those of the rows that were requested."""
    top: int = 0
    """Number of the first one."""
    total: int = 0
    """Events in all."""
    current: int = -1
    """Number of the newest event at the position; -1: before the first one."""
    current_event: ReplayEvent | None = None
    searching: str = ""
    """What is being searched."""
    note: str = ""
    """Answer to the newest key: what was found, or why not."""
    notes: int = 0
    """Counts the notes: one that is the same again is new."""
