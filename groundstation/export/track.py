"""Tracks of vehicles: their positions in order, in segments, and what they said where.

A position is GLOBAL_POSITION_INT, the estimate; until a vehicle sends one, GPS_RAW_INT with a fix.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from typing import BinaryIO

import msgspec
from msgspec.structs import replace

from dialects.enums import Severity
from dialects.kinds import KINDS, TypeRow
from dialects.messages import GlobalPositionInt, GpsRawInt, Heartbeat, StatusText
from groundstation.export.sample import Sample
from groundstation.geo import FIX_2D, read_place
from groundstation.vehicles.state.chunked_texts import TextJoiner
from groundstation.vehicles.state.vehicle_heartbeat import is_vehicle

PAUSE = 10_000_000
"""us without a position that end a segment: a line across the gap would show a path that was not recorded."""


GROUND = TypeRow("vehicle", "")
SEGMENT = b"\0"
"""Stands between two segments until the track is written: only then its kind is known for sure."""


class Position(msgspec.Struct, frozen=True):
    """Where a vehicle was; degrees, m above mean sea level."""

    microseconds: int
    latitude: float
    longitude: float
    altitude: float


class Remark(msgspec.Struct, frozen=True):
    """A warning of a vehicle, and where it was then."""

    system: int
    text: str
    position: Position


class RecordedTrack(msgspec.Struct):
    """The points of one vehicle, in a file without a name: a long track needs no memory. `write` formats a point."""

    write: Callable[[Position], str]
    between: Callable[[bool], str]
    """Returns what stands between two segments; takes `flies`."""
    flies: bool = False
    """It is a kind of vehicle whose altitude is not that of the ground."""
    estimated: bool = False
    first: Position | None = None
    last: Position | None = None
    broken: bool = False
    """The next point begins a segment."""
    spool: BinaryIO = msgspec.field(default_factory=tempfile.TemporaryFile)

    def add(self, position: Position) -> None:
        """Add a point."""
        if self.last is not None and (self.broken or position.microseconds - self.last.microseconds > PAUSE):
            self.spool.write(SEGMENT)
        self.spool.write(self.write(position).encode())
        self.first = self.first or position
        self.last, self.broken = position, False

    def read(self) -> Iterator[bytes]:
        """Yield all points as they were written."""
        self.spool.seek(0)
        between = self.between(self.flies).encode()
        while part := self.spool.read(1 << 16):
            yield part.replace(SEGMENT, between)


class Tracks:
    """Collects the tracks of all vehicles."""

    def __init__(self, write: Callable[[Position], str], between: Callable[[bool], str]) -> None:
        self._write, self._between = write, between
        self.of: dict[int, RecordedTrack] = {}
        """System id -> its track."""
        self.remarks: list[Remark] = []
        self.count = 0
        self._fliers: set[int] = set()
        """System ids of what flies, by its HEARTBEAT."""
        self._joiner = TextJoiner()

    def add(self, sample: Sample) -> None:
        """Handle a message that has a position, or a warning."""
        if sample.kind is GlobalPositionInt or sample.kind is GpsRawInt:
            self._add_position(sample)
        elif sample.kind is Heartbeat:
            self._add_kind(sample)
        elif sample.kind is StatusText:
            self._add_remark(sample)

    def close(self) -> None:
        """Remove the points."""
        for track in self.of.values():
            track.spool.close()

    def _add_position(self, sample: Sample) -> None:
        message = sample.message
        assert isinstance(message, GlobalPositionInt | GpsRawInt)
        place = read_place(message.lat, message.lon)
        if isinstance(message, GpsRawInt) and message.fix_type < FIX_2D:
            place = None
        track = self.of.get(sample.system)
        if isinstance(message, GpsRawInt) and track is not None and track.estimated:
            return
        if place is None:
            if track is not None:
                track.broken = True
            return
        if track is None:
            track = self.of[sample.system] = RecordedTrack(self._write, self._between)
            track.flies = sample.system in self._fliers
        track.estimated = isinstance(message, GlobalPositionInt)
        track.add(Position(sample.microseconds, *place, message.alt / 1000))
        self.count += 1

    def _add_kind(self, sample: Sample) -> None:
        message = sample.message
        assert isinstance(message, Heartbeat)
        if is_vehicle(message) and KINDS.get(message.type, GROUND).falls:
            self._fliers.add(sample.system)
            if (track := self.of.get(sample.system)) is not None:
                track.flies = True

    def _add_remark(self, sample: Sample) -> None:
        message = sample.message
        assert isinstance(message, StatusText)
        track = self.of.get(sample.system)
        text = self._joiner.add(message, sample.system, sample.component, sample.microseconds / 1e6)
        for _ in self._joiner.pop_overdue(sample.microseconds / 1e6):
            pass  # their remarks are there already
        if text.made is not None:
            self.remarks[text.made] = replace(self.remarks[text.made], text=text.text)
        elif text.severity <= Severity.WARNING and track is not None and track.last:
            text.made = len(self.remarks)
            self.remarks.append(Remark(sample.system, text.text, track.last))
