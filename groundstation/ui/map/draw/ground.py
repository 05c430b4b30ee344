"""Ground: the cursor on the map, what is measured, and which part of the ground is in view."""

from __future__ import annotations

import math
from enum import Enum, auto

from groundstation.geo import LocalFrame, Place, Point, keep_on_earth
from groundstation.ui.map.draw.window import FITTED, MapWindow, fit_window


class Looking(Enum):
    """What the map keeps in view."""

    FIT = auto()
    """Everything."""
    FOLLOW = auto()
    """The vehicle."""
    FREE = auto()
    """The cursor."""


NOT_FITTED = MapWindow(math.inf, math.inf)
"""Before the first fit, and where a fit is asked for: it shows nothing."""


class Ground:
    """`frame` is the map's metres; None as long as nothing has a place."""

    def __init__(self) -> None:
        self.frame: LocalFrame | None = None
        self.vehicle: Point | None = None
        self.cursor: Place | None = None
        self.measured: Place | None = None
        """Where the measured line begins."""
        self.looking = Looking.FIT
        self.window = NOT_FITTED
        self._size = (0, 0)

    @property
    def cursor_point(self) -> Point | None:
        """The cursor on the map."""
        return None if self.frame is None or self.cursor is None else self.frame.to_point(self.cursor)

    def set_size(self, width: int, height: int) -> None:
        """Set the size of the map in cells; 0: it is not laid out yet, or hidden."""
        size = width * 2, height * 4
        if size != self._size and self.looking is Looking.FIT:
            self.window = NOT_FITTED
        self._size = size

    def look(self, points: tuple[Point, ...]) -> None:
        """Move the window so that it shows what it shall; `points` are all that a fit shows."""
        if 0 in self._size:
            return
        target = self.vehicle if self.looking is Looking.FOLLOW else self.cursor_point
        if self.looking is Looking.FIT:
            if not self._fits(points):
                self.window = fit_window(points, *self._size)
        elif target is not None:
            self.window = self.window.around(target, *self._size)

    def _fits(self, points: tuple[Point, ...]) -> bool:
        """Return whether the window still is a good one: a fit at each step would move the map all the time."""
        inside = all(self.window.shows(point, *self._size, 0.47) for point in points)
        closer = self.window.zoomed(-2)
        loose = FITTED <= closer.zoom < self.window.zoom and all(
            closer.shows(point, *self._size, 0.4) for point in points
        )
        return inside and not loose

    def fit(self) -> None:
        """Show everything."""
        self.looking = Looking.FIT
        self.window = NOT_FITTED

    def follow(self) -> None:
        """Keep the vehicle in view, or stop that."""
        self.looking = Looking.FREE if self.looking is Looking.FOLLOW else Looking.FOLLOW

    def zoom(self, by: int) -> None:
        """Zoom in (-1) or out (+1) around the vehicle while it is followed, else around the cursor."""
        if self.window is NOT_FITTED:
            return
        centre = self.vehicle if self.looking is Looking.FOLLOW else self.cursor_point
        if self.looking is Looking.FIT:
            self.looking = Looking.FREE
        north, east = centre if centre is not None else (self.window.north, self.window.east)
        self.window = MapWindow(north, east, self.window.zoom).zoomed(by)

    def move(self, up: int, right: int) -> None:
        """Move the cursor by cells."""
        point = self.cursor_point
        if self.frame is None or point is None or self.window is NOT_FITTED:
            return
        scale = self.window.scale
        moved = (point[0] + up * 4 * scale, point[1] + right * 2 * scale)
        self.cursor = keep_on_earth(self.frame.to_place(moved))
        if self.looking is Looking.FIT and not self.window.shows(moved, *self._size, 0.48):
            self.looking = Looking.FREE

    def measure(self) -> None:
        """Measure from the cursor, or stop that."""
        self.measured = None if self.measured is not None else self.cursor

    def reset(self) -> None:
        """Forget the places of another vehicle."""
        self.cursor = self.measured = None
        self.fit()
