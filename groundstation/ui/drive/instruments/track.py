"""Track map: the path, position and heading of the vehicle, and its distance from home. North is up."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import msgspec
from textual.strip import Strip

from groundstation.geo import place_around
from groundstation.snapshot import VehicleView
from groundstation.ui.look.colours import AMBER, BLUE, DIM, LINE, RED, YELLOW, style, theme_changes
from groundstation.ui.widgets.canvas import Canvas, Point, draw_obstacles
from groundstation.ui.widgets.instrument import Instrument, finite_or_none

REACH = 150.0
"""m: track points and home within this distance of the vehicle are kept in view, those farther away are not."""

MIN_SCALE = 0.08
"""m per dot: at a smaller scale GPS noise would move the vehicle visibly."""

_STEPS = (1.0, 1.4, 2.0, 3.0, 5.0, 7.0)
_RINGS = (1.0, 2.0, 5.0)


class TrackValue(msgspec.Struct, frozen=True):
    """Contents of the map; positions are (north, east) in m."""

    position: Point | None = None
    heading: float | None = None
    home: Point | None = None
    track: tuple[Point, ...] = ()
    ascii: bool = False
    """Draw the vehicle as one character: its outline needs braille."""
    zoom: int = 0
    """Each step up halves what is shown around the vehicle; 0: all of the near track and home."""
    obstacles: tuple[Point, ...] = ()

    @classmethod
    def from_vehicle(
        cls,
        vehicle: VehicleView | None,
        track: tuple[Point, ...],
        *,
        ascii: bool = False,  # noqa: A002
        zoom: int = 0,
    ) -> TrackValue:
        """Return the map of a vehicle, rounded to what a dot can show."""
        if vehicle is None or vehicle.position is None or not all(map(math.isfinite, vehicle.position)):
            return cls()
        north, east = vehicle.position
        heading = finite_or_none(vehicle.heading)
        rounded = None if heading is None else round(heading, 1)
        seen = () if heading is None else place_around((north, east), heading, vehicle.obstacles)
        return cls((round(north, 2), round(east, 2)), rounded, vehicle.home, track, ascii, zoom, seen)


class MapView(msgspec.Struct, frozen=True):
    """The visible area: its middle (north, east), m per dot, and the spacing of its rings in m."""

    north: float
    east: float
    scale: float
    ring: float

    def to_canvas(self, point: Point, canvas: Canvas) -> Point:
        """Return the position of a (north, east) point on the canvas."""
        north, east = point
        x = canvas.across / 2 + (east - self.east) / self.scale
        return x, canvas.down / 2 - (north - self.north) / self.scale


def fit_view(value: TrackValue, across: int, down: int) -> MapView:
    """Return the closest view that contains the vehicle, its near track and home, in steps so that it seldom changes.

    A view that follows each metre would redraw the whole map ten times a second, also over a slow line.
    """
    vehicle = value.position or (0.0, 0.0)
    points = [point for point in (*value.track, value.home or vehicle) if math.dist(point, vehicle) < REACH]
    points.append(vehicle)
    norths, easts = [north for north, _ in points], [east for _, east in points]
    north, east = (min(norths) + max(norths)) / 2, (min(easts) + max(easts)) / 2
    for view in _views(north, east, min(across, down)):
        tall = max(abs(max(norths) - view.north), abs(min(norths) - view.north)) / view.scale
        wide = max(abs(max(easts) - view.east), abs(min(easts) - view.east)) / view.scale
        if tall < down * 0.42 and wide < across * 0.44:
            break
    return _zoomed(view, value.zoom, vehicle, min(across, down)) if value.zoom else view


def _zoomed(view: MapView, zoom: int, vehicle: Point, dots: int) -> MapView:
    """Return a view that shows less (zoom > 0), around the vehicle, or more of the surroundings."""
    scale = max(MIN_SCALE / 4, view.scale * 0.5**zoom)
    ring = _ring(scale * max(8, dots) / 5)
    north, east = vehicle if zoom > 0 else (view.north, view.east)
    return MapView(round(north / ring * 2) * ring / 2, round(east / ring * 2) * ring / 2, scale, ring)


def _views(north: float, east: float, dots: int) -> Iterator[MapView]:
    for decade in range(-2, 4):
        for step in _STEPS:
            scale = step * 10.0**decade
            if scale < MIN_SCALE:
                continue
            ring = _ring(scale * max(8, dots) / 5)
            yield MapView(round(north / ring * 2) * ring / 2, round(east / ring * 2) * ring / 2, scale, ring)


def _ring(at_least: float) -> float:
    decade = 10.0 ** math.floor(math.log10(at_least))
    return next((step * decade for step in _RINGS if step * decade >= at_least), 10 * decade)


class TrackMap(Instrument[TrackValue]):
    """The map."""

    BORDER_TITLE = "track"

    def __init__(self, value: TrackValue, **options: Any) -> None:
        super().__init__(value, **options)
        self._base: _Base | None = None

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw rings and home, the track over them, and the vehicle on top."""
        value = self.value
        if value.position is None:
            canvas = Canvas(width, height)
            canvas.write(max(0, width // 2 - 7), height // 2, "no position yet", style(DIM))
            return canvas.strips()
        view = fit_view(value, width * 2, height * 4)
        if self._base is None or not self._base.extend(value, view, (width, height)):
            self._base = _Base(value, view, (width, height))
        self._base.canvas.strips()  # before the copy, which then has those of the rows that nothing is drawn in
        canvas = self._base.canvas.copy()
        canvas.path([view.to_canvas(point, canvas) for point in (*value.track[-1:], value.position)], style(BLUE))
        if value.home is not None:
            x, y = view.to_canvas(value.home, canvas)
            canvas.write(int(x) >> 1, int(y) >> 2, "⌂", style(AMBER, bold=True))
        draw_obstacles(canvas, [view.to_canvas(point, canvas) for point in value.obstacles])
        _draw_vehicle(canvas, view.to_canvas(value.position, canvas), value.heading, ascii=value.ascii)
        _draw_labels(canvas, view, value)
        return canvas.strips()


class _Base:
    """Rings and track, which are drawn once; points that are added to the track are drawn when they come."""

    def __init__(self, value: TrackValue, view: MapView, size: tuple[int, int]) -> None:
        self.canvas = Canvas(*size)
        self._key = (view, size, value.home, theme_changes())
        self._track = value.track
        _draw_rings(self.canvas, view, value.home or (0.0, 0.0))
        self._draw(value.track, view)

    def extend(self, value: TrackValue, view: MapView, size: tuple[int, int]) -> bool:
        """Draw what was added to the track. Return False if it is not the base of this value."""
        known = len(self._track)
        if self._key != (view, size, value.home, theme_changes()) or value.track[:known] != self._track:
            return False
        self._draw(value.track[max(0, known - 1) :], view)
        self._track = value.track
        return True

    def _draw(self, points: Sequence[Point], view: MapView) -> None:
        self.canvas.path([view.to_canvas(point, self.canvas) for point in points], style(BLUE))


def _draw_rings(canvas: Canvas, view: MapView, home: Point) -> None:
    x, y = view.to_canvas(home, canvas)
    farthest = math.hypot(max(x, canvas.across - x), max(y, canvas.down - y))
    spacing = view.ring / view.scale
    for number in range(1, min(12, int(farthest / spacing)) + 1):
        radius = spacing * number
        for step in range(count := max(24, int(radius * 2.4))):
            angle = step * math.tau / count
            canvas.dot(round(x + radius * math.cos(angle)), round(y + radius * math.sin(angle)), style(LINE))
        canvas.write((int(x + radius) >> 1) + 1, int(y) >> 2, _metres(view.ring * number), style(DIM))


def _draw_vehicle(canvas: Canvas, at: Point, heading: float | None, *, ascii: bool) -> None:  # noqa: A002
    x, y = at
    if heading is None or ascii:
        mark = "●" if heading is None else "^>v<"[round(heading / (math.pi / 2)) % 4]
        canvas.write(int(x) >> 1, int(y) >> 2, mark, style(YELLOW, bold=True))
        return
    along, aside = math.sin(heading), math.cos(heading)
    corners = [(9.0, 0.0), (-4.5, 4.0), (-2.0, 0.0), (-4.5, -4.0)]  # dots ahead, dots to the right
    canvas.fill([(x + a * along + b * aside, y - a * aside + b * along) for a, b in corners], style(YELLOW))


def _draw_labels(canvas: Canvas, view: MapView, value: TrackValue) -> None:
    canvas.write(canvas.width // 2, 0, "N", style(RED, bold=True))
    bar = max(2, round(view.ring / view.scale / 2))
    if bar < canvas.width // 2:
        canvas.write(1, canvas.height - 1, "├" + "─" * (bar - 1) + "┤ " + _metres(view.ring), style(DIM))
    if value.home is not None and value.position is not None:
        text = f"home {math.dist(value.home, value.position):.1f} m"
        canvas.write(canvas.width - len(text) - 1, canvas.height - 1, text, style(DIM))


def _metres(distance: float) -> str:
    return f"{distance:g} m" if distance < 1000 else f"{distance / 1000:g} km"
