"""What the simulated rover sees: sky, ground with a grid of metres, walls, and posts at home and at waypoints.

A picture is made of palette indexes, one byte a pixel, and becomes planes of green, blue and red by a table. Rows and
columns are filled by slices: a picture of 320x180 takes some milliseconds.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

HEIGHT = 0.35
"""m of the camera above the ground."""
FIELD_OF_VIEW = math.radians(70)
PITCH = 0.12
"""Share of the picture's height by which the horizon is above its middle: the camera looks down a little."""
NEAR = 0.15
"""m; nothing nearer is drawn."""
GRID_REACH = 10
"""m to which the grid is drawn."""
FAR = 60.0
"""m to which walls and posts are drawn."""
WALL_HEIGHT = 0.6
POST_WIDTH = 0.12

SKY, GROUND, LINE, WALL, HOME, WAYPOINT = 0, 32, 64, 96, 128, 160
"""First index of each colour, which has SHADES of them from near to far; the sky from top to bottom."""
SHADES = 32
_COLOURS: dict[int, tuple[tuple[int, int, int], tuple[int, int, int]]] = {
    SKY: ((70, 130, 200), (190, 215, 235)),
    GROUND: ((92, 105, 78), (150, 160, 145)),
    LINE: ((205, 210, 190), (165, 172, 160)),
    WALL: ((176, 92, 62), (160, 135, 125)),
    HOME: ((240, 200, 40), (215, 195, 120)),
    WAYPOINT: ((200, 60, 190), (190, 140, 190)),
}


def _table(channel: int) -> bytes:
    table = bytearray(256)
    for first, (near, far) in _COLOURS.items():
        for shade in range(SHADES):
            share = shade / (SHADES - 1)
            table[first + shade] = round(near[channel] + share * (far[channel] - near[channel]))
    return bytes(table)


_RED, _GREEN, _BLUE = (_table(channel) for channel in range(3))

ScenePoint = tuple[float, float]
"""m north and east."""


class Pose(NamedTuple):
    """Where the camera is and looks."""

    north: float = 0.0
    east: float = 0.0
    yaw: float = 0.0
    """rad clockwise from north."""


class Scene:
    """Draws pictures of one size."""

    def __init__(
        self,
        width: int,
        height: int,
        walls: Sequence[tuple[ScenePoint, ScenePoint]] = (),
        home: ScenePoint | None = (0, 0),
    ):
        self._width, self._height = width, height
        self._focus = width / 2 / math.tan(FIELD_OF_VIEW / 2)
        self._horizon = height * (0.5 - PITCH)
        self._walls, self._home = tuple(walls), home
        self._empty = self._draw_empty()

    def draw(self, pose: Pose, waypoints: Iterable[ScenePoint] = ()) -> bytes:
        """Return the planes of green, blue and red, as the pixel format gbrp has them."""
        pixels = bytearray(self._empty)
        self._draw_grid(pixels, pose)
        posts = [(WAYPOINT, place, 0.8) for place in waypoints]
        if self._home is not None:
            posts.append((HOME, self._home, 1.2))
        spans: list[tuple[int, ScenePoint, ScenePoint, float]] = [
            (WALL, self._turn(first, pose), self._turn(second, pose), WALL_HEIGHT) for first, second in self._walls
        ]
        for colour, place, height in posts:
            ahead, right = self._turn(place, pose)
            spans.append((colour, (ahead, right - POST_WIDTH / 2), (ahead, right + POST_WIDTH / 2), height))
        self._draw_spans(pixels, spans)
        return bytes(pixels.translate(_GREEN) + pixels.translate(_BLUE) + pixels.translate(_RED))

    def _draw_empty(self) -> bytes:
        """Return sky and ground."""
        rows = []
        for y in range(self._height):
            below = y + 0.5 - self._horizon
            if below <= 0:
                index = SKY + min(SHADES - 1, int((y + 0.5) / self._horizon * SHADES))
            else:
                index = GROUND + _shade(HEIGHT * self._focus / below)
            rows.append(bytes((index,)) * self._width)
        return b"".join(rows)

    @staticmethod
    def _turn(place: ScenePoint, pose: Pose) -> ScenePoint:
        """Return the m ahead and to the right of the camera."""
        north, east = place[0] - pose.north, place[1] - pose.east
        cosine, sine = math.cos(pose.yaw), math.sin(pose.yaw)
        return north * cosine + east * sine, east * cosine - north * sine

    def _draw_grid(self, pixels: bytearray, pose: Pose) -> None:
        north, east = round(pose.north), round(pose.east)
        for offset in range(-GRID_REACH, GRID_REACH + 1):
            for ends in (
                ((north + offset, east - GRID_REACH), (north + offset, east + GRID_REACH)),
                ((north - GRID_REACH, east + offset), (north + GRID_REACH, east + offset)),
            ):
                clipped = _clip(self._turn(ends[0], pose), self._turn(ends[1], pose))
                if clipped is not None:
                    self._draw_line(pixels, *clipped)

    def _draw_line(self, pixels: bytearray, start: ScenePoint, end: ScenePoint) -> None:
        """Draw a line on the ground."""
        focus, width, height, horizon = self._focus, self._width, self._height, self._horizon
        x1, y1 = width / 2 + focus * start[1] / start[0], horizon + focus * HEIGHT / start[0]
        x2, y2 = width / 2 + focus * end[1] / end[0], horizon + focus * HEIGHT / end[0]
        inside = _clip_to(x1, y1, x2, y2, width - 1, height - 1)
        if inside is None:
            return
        x1, y1, x2, y2 = inside
        steps = max(1, int(max(abs(x2 - x1), abs(y2 - y1))))
        dx, dy = (x2 - x1) / steps, (y2 - y1) / steps
        near = focus * HEIGHT
        for step in range(steps + 1):
            x, y = int(x1 + step * dx), int(y1 + step * dy)
            pixels[y * width + x] = LINE + _shade(near / max(1.0, y - horizon))

    def _draw_spans(self, pixels: bytearray, spans: Iterable[tuple[int, ScenePoint, ScenePoint, float]]) -> None:
        """Draw upright rectangles between two places; the nearest one of a column is in front."""
        columns: list[list[tuple[float, int, float]]] = [[] for _ in range(self._width)]
        middle, focus = self._width / 2, self._focus
        for colour, first, second, tall in spans:
            clipped = _clip(first, second)
            if clipped is None:
                continue
            (ahead1, right1), (ahead2, right2) = clipped
            x1, x2 = middle + focus * right1 / ahead1, middle + focus * right2 / ahead2
            if x1 > x2:
                x1, x2, ahead1, ahead2 = x2, x1, ahead2, ahead1
            for x in range(max(0, math.ceil(x1 - 0.5)), min(self._width, math.ceil(x2 + 0.5))):
                share = min(1.0, max(0.0, (x - x1) / (x2 - x1))) if x2 > x1 else 0.0
                ahead = 1 / (1 / ahead1 + share * (1 / ahead2 - 1 / ahead1))
                columns[x].append((ahead, colour, tall))
        for x, found in enumerate(columns):
            for ahead, colour, tall in sorted(found, reverse=True):
                self._draw_column(pixels, x, ahead, colour, tall)

    def _draw_column(self, pixels: bytearray, x: int, ahead: float, colour: int, tall: float) -> None:
        if ahead > FAR:
            return
        top = max(0, int(self._horizon + self._focus * (HEIGHT - tall) / ahead))
        bottom = min(self._height, int(self._horizon + self._focus * HEIGHT / ahead) + 1)
        if bottom > top:
            column = slice(top * self._width + x, (bottom - 1) * self._width + x + 1, self._width)
            pixels[column] = bytes((colour + _shade(ahead),)) * (bottom - top)


def _shade(distance: float) -> int:
    return min(SHADES - 1, int(distance / 20 * SHADES))


def _clip(start: ScenePoint, end: ScenePoint) -> tuple[ScenePoint, ScenePoint] | None:
    """Return the part of a segment that is ahead of the camera; None without one."""
    if start[0] < NEAR and end[0] < NEAR:
        return None
    if start[0] < NEAR:
        return _cut(end, start), end
    return (start, _cut(start, end)) if end[0] < NEAR else (start, end)


def _cut(front: ScenePoint, behind: ScenePoint) -> ScenePoint:
    share = (front[0] - NEAR) / (front[0] - behind[0])
    return NEAR, front[1] + share * (behind[1] - front[1])


def _clip_to(
    x1: float, y1: float, x2: float, y2: float, right: float, bottom: float
) -> tuple[float, float, float, float] | None:
    """Return the part of a line inside of 0..right, 0..bottom (Liang and Barsky); None without one."""
    low, high = 0.0, 1.0
    dx, dy = x2 - x1, y2 - y1
    for along, room in ((-dx, x1), (dx, right - x1), (-dy, y1), (dy, bottom - y1)):
        if along == 0:
            if room < 0:
                return None
        elif along < 0:
            low = max(low, room / along)
        else:
            high = min(high, room / along)
    if low > high:
        return None
    return x1 + low * dx, y1 + low * dy, x1 + high * dx, y1 + high * dy
