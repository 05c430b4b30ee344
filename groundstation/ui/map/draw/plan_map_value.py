"""What a map shows: a mission, a fence, rally points, layers of files, the vehicle and the cursor."""

from __future__ import annotations

from enum import Enum

import msgspec
from msgspec.structs import replace

from groundstation.geo import Point
from groundstation.ui.map.draw.window import MapWindow


class LegState(Enum):
    """How a leg of the mission is drawn: by line style, not by colour alone."""

    DONE = "done"
    NOW = "now"
    TO_GO = "to go"


class MapLeg(msgspec.Struct, frozen=True):
    """A leg of the mission."""

    start: Point
    end: Point
    look: LegState = LegState.TO_GO


class MapMark(msgspec.Struct, frozen=True):
    """A label at a point."""

    point: Point
    text: str
    look: str = "item"
    """A key of MARKS (plan_drawing.py)."""


class MapOutline(msgspec.Struct, frozen=True):
    """A polygon of the fence; closed."""

    corners: tuple[Point, ...]
    inclusion: bool = True


class MapShape(msgspec.Struct, frozen=True):
    """A shape of a layer: a point, a line, or an area (`closed`)."""

    points: tuple[Point, ...]
    closed: bool = False
    name: str = ""


class PlanMapValue(msgspec.Struct, frozen=True):
    """Contents of the map; points are (north, east) in m around one place."""

    note: str = "no position yet"
    """Shown in place of the map; empty: there is a map."""
    window: MapWindow | None = None
    """None: everything is in view."""
    home: Point | None = None
    vehicle: Point | None = None
    heading: float | None = None
    """Clockwise from north, rad."""
    track: tuple[Point, ...] = ()
    obstacles: tuple[Point, ...] = ()
    """What the range sensors of the vehicle see; a fit leaves them out."""
    legs: tuple[MapLeg, ...] = ()
    outlines: tuple[MapOutline, ...] = ()
    layers: tuple[MapShape, ...] = ()
    layer_corners: tuple[Point, ...] = ()
    """Corners of what a fit brings into view of them."""
    marks: tuple[MapMark, ...] = ()
    cursor: Point | None = None
    measured: Point | None = None
    """Where the measured line begins; it ends at the cursor."""
    lines: tuple[str, ...] = ()
    """Written at the bottom, above the scale."""
    ascii: bool = False
    """Draw the vehicle as one character: its outline needs braille."""

    def with_lines(self, lines: tuple[str, ...]) -> PlanMapValue:
        """Return the map with texts at the bottom."""
        return replace(self, lines=lines)

    @property
    def points(self) -> tuple[Point, ...]:
        """Everything that a fit brings into view."""
        ends = [point for leg in self.legs for point in (leg.start, leg.end)]
        corners = [corner for outline in self.outlines for corner in outline.corners]
        alone = [point for point in (self.home, self.vehicle) if point is not None]
        return (*self.layer_corners, *ends, *corners, *alone, *(mark.point for mark in self.marks), *self.track)
