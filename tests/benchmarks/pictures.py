"""Pictures of how cost grows, as SVG: one file for each row of PICTURES whose benchmark is in the results of a run.

Both axes are logarithmic: equal cost for each unit is a straight line of slope 1, drawn thin from the first point.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from tests.benchmarks.figures import brief

WIDTH, HEIGHT = 640, 360
LEFT, RIGHT, TOP, BOTTOM = 70, 30, 60, 60
"""Margins around the field of the points."""
INK, FAINT, LINE, PAPER = "#222222", "#c8c8c8", "#0a5fb4", "#ffffff"


@dataclass(frozen=True, slots=True)
class Picture:
    """One picture: columns of the first table of a benchmark."""

    benchmark: str
    title: str
    x: str
    y: str
    x_label: str
    y_label: str
    offset: int = 0
    """Added to x: a driven vehicle beside `further vehicles`."""

    @property
    def file(self) -> str:
        """Return the name of its file."""
        return f"cost_{self.benchmark}.svg"


CPU = "CPU, % of a core"
PICTURES = (
    Picture("message_rates", "Ground station by messages a second", "messages/s", "CPU %", "messages a second", CPU),
    Picture("stations", "Vehicle by ground stations", "stations", "CPU %", "ground stations", CPU),
    Picture("bridge_stations", "Bridge by ground stations", "stations", "CPU %", "ground stations", CPU),
    Picture("fleet", "Ground station by vehicles", "further vehicles", "CPU %", "vehicles", CPU, offset=1),
)


def write_pictures(run: Mapping[str, Any], folder: Path) -> list[Path]:
    """Draw what a run (its JSON) has results for; return the files. The folder is created if necessary."""
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for picture in PICTURES:
        if picture.benchmark in run["results"]:
            rows = run["results"][picture.benchmark]["tables"][0]["rows"]
            points = [(float(row[picture.x] + picture.offset), float(row[picture.y])) for row in rows]
            file = folder / picture.file
            file.write_text(draw(picture, points, caption(run)))
            written.append(file)
    return written


def caption(run: Mapping[str, Any]) -> str:
    """Return when and where the run was made."""
    machine = run["machine"]
    kind = "quick run" if run["quick"] else "full run"
    day = machine["date"][:16].replace("T", " ")
    where = f"{machine['cpu']}, {machine['cores']} cores, load {machine['load_before']}"
    return f"{kind}, {day}, commit {machine['commit']}, {where}"


def draw(picture: Picture, points: Sequence[tuple[float, float]], below: str) -> str:
    """Return the SVG of some points, each x and y above 0."""
    xs, ys = _Scale([x for x, _ in points], LEFT, WIDTH - RIGHT), _Scale([y for _, y in points], HEIGHT - BOTTOM, TOP)
    spoken = "; ".join(f"{brief(x)} {picture.x_label}: {brief(y)} %" for x, y in points)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" '
        'aria-labelledby="title desc" font-family="sans-serif" font-size="13">',
        f'<title id="title">{escape(picture.title)}</title>',
        f'<desc id="desc">{escape(f"{picture.y_label}. {spoken}.")}</desc>',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="{PAPER}"/>',
        _text(WIDTH / 2, 24, picture.title, size=16),
        _text(WIDTH / 2, 43, picture.y_label),
        *(_line(xs.at(tick), TOP, xs.at(tick), HEIGHT - BOTTOM, FAINT) for tick in xs.ticks),
        *(_line(LEFT, ys.at(tick), WIDTH - RIGHT, ys.at(tick), FAINT) for tick in ys.ticks),
        *(_text(xs.at(tick), HEIGHT - BOTTOM + 18, f"{tick:g}") for tick in xs.ticks),
        *(_text(LEFT - 8, ys.at(tick) + 4, f"{tick:g}", anchor="end") for tick in ys.ticks),
        _text(WIDTH / 2, HEIGHT - 24, picture.x_label),
        _text(WIDTH / 2, HEIGHT - 7, below, size=10),
        *_proportional(points[0], xs, ys),
        f'<polyline fill="none" stroke="{LINE}" stroke-width="2" points="'
        + " ".join(f"{xs.at(x):.1f},{ys.at(y):.1f}" for x, y in points)
        + '"/>',
    ]
    for x, y in points:
        parts.append(f'<circle cx="{xs.at(x):.1f}" cy="{ys.at(y):.1f}" r="4" fill="{LINE}"/>')
        parts.append(_text(xs.at(x), ys.at(y) + 20, brief(y)))  # below: the dashed line is above
    return "\n".join([*parts, "</svg>", ""])


class _Scale:
    """A logarithmic axis that ends at powers of ten, or halfway, around its values."""

    def __init__(self, values: Sequence[float], start: float, end: float) -> None:
        self._start, self._end = start, end
        low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
        self._low, self._high = float(low), float(max(high, low + 1))
        steps = (tick * 10**power for power in range(low, max(high, low + 1) + 1) for tick in (1, 3))
        self.ticks = [tick for tick in steps if self._low <= math.log10(tick) <= self._high]

    def at(self, value: float) -> float:
        """Return the place of a value in the picture."""
        share = (math.log10(value) - self._low) / (self._high - self._low)
        return self._start + share * (self._end - self._start)

    @property
    def highest(self) -> float:
        """Return the value at the end."""
        return 10**self._high


def _proportional(first: tuple[float, float], xs: _Scale, ys: _Scale) -> list[str]:
    """Return the line along which each unit costs what the first ones cost."""
    x, y = first
    factor = min(xs.highest / x, ys.highest / y)
    return [_line(xs.at(x), ys.at(y), xs.at(x * factor), ys.at(y * factor), INK, dash="4 4")] if factor > 1 else []


def _line(x1: float, y1: float, x2: float, y2: float, colour: str, dash: str = "none") -> str:
    where = f'x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"'
    return f'<line {where} stroke="{colour}" stroke-dasharray="{dash}"/>'


def _text(x: float, y: float, text: str, anchor: str = "middle", size: int = 13) -> str:
    where = f'x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}"'
    return f'<text {where} fill="{INK}">{escape(text)}</text>'
