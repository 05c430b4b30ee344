"""What a running app shows, cell by cell: as text for the goldens, as an SVG picture for people."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, cast
from xml.sax.saxutils import escape

from rich.segment import Segment
from rich.style import Style
from textual._compositor import LayoutUpdate
from textual.app import App
from textual.strip import Strip

WIDTH, HEIGHT, BASELINE = 10, 20, 15
"""Pixels of a cell, and of the baseline of its letters."""

FONT = "JetBrains Mono, DejaVu Sans Mono, monospace"
GROUND, INK = "#0b0e14", "#c9d1d9"

_BRAILLE = 0x2800
_DOTS = ((0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (0, 3), (1, 3))
"""Column and row of each bit of a braille character."""

_LINES = {"─": "lr", "│": "ud", "╭": "rd", "╮": "ld", "╰": "ru", "╯": "lu", "├": "udr", "┤": "udl", "┴": "lru",
          "╶": "r", "╴": "l", "╷": "d", "╵": "u", "━": "LR", "┃": "UD"}  # fmt: skip
"""Box characters -> where from the middle they go; capitals are heavy. Drawn, because fonts leave gaps."""

Cell = tuple[str, Style]
Picture = list[list[Cell]]


def cells(app: App[Any]) -> Picture:
    """The whole terminal, with the screens below a modal one."""
    return [[cell for segments in chops for cell in _characters(segments)] for chops in _strips(app)]


def _strips(app: App[Any]) -> list[Iterable[Iterable[Segment]]]:
    """Return the pieces of each line."""
    update = app.screen._compositor.render_update(full=True, screen_stack=app._background_screens)
    return cast(list[Iterable[Iterable[Segment]]], cast(LayoutUpdate, update).strips)


def _characters(segments: Iterable[Segment]) -> Iterator[Cell]:
    for segment in segments:
        for character in segment.text:
            yield character, segment.style or Style()


def text(app: App[Any]) -> str:
    """One line a row, without the spaces at its end."""
    rows = ["".join(segment.text for segments in chops for segment in segments).rstrip() for chops in _strips(app)]
    return "\n".join(rows) + "\n"


def texts(strips: Iterable[Strip]) -> list[str]:
    """Return the text of each line that an instrument draws."""
    return [strip.text for strip in strips]


def svg(rows: Picture) -> str:
    """Return a picture in which each character stands exactly in its cell, as a terminal draws it."""
    width, height = WIDTH * max(map(len, rows)), HEIGHT * len(rows)
    body = "\n".join(part for y, row in enumerate(rows) for part in _row(row, y * HEIGHT))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
        f'font-family="{FONT}" font-size="16.4">\n<rect width="{width}" height="{height}" fill="{GROUND}"/>\n'
        f"{body}\n</svg>\n"
    )


def _row(row: list[Cell], top: int) -> Iterator[str]:
    for column, (_, look) in enumerate(row):
        _, ground = colours(look)
        if ground != GROUND:
            yield _rectangle(column * WIDTH, top, WIDTH + 0.3, HEIGHT + 0.3, ground)
    for column, (character, look) in enumerate(row):
        if character != " ":
            yield from _glyph(character, look, column * WIDTH, top)


def _glyph(character: str, look: Style, left: int, top: int) -> Iterator[str]:
    ink, _ = colours(look)
    code = ord(character)
    if _BRAILLE <= code < _BRAILLE + 256:
        for bit, (x, y) in enumerate(_DOTS):
            if (code - _BRAILLE) >> bit & 1:
                yield f'<circle cx="{left + 2.5 + 5 * x}" cy="{top + 2.5 + 5 * y}" r="1.4" fill="{ink}"/>'
    elif "▁" <= character <= "█":
        tall = HEIGHT * (code - ord("▁") + 1) / 8
        yield _rectangle(left, top + HEIGHT - tall, WIDTH, tall, ink)
    elif "▉" <= character <= "▏":
        wide = WIDTH * (ord("▏") - code + 1) / 8
        yield _rectangle(left, top, wide, HEIGHT, ink)
    elif character in _LINES:
        yield _box(_LINES[character], left + WIDTH / 2, top + HEIGHT / 2, ink)
    else:
        weight = ' font-weight="bold"' if look.bold else ""
        yield f'<text x="{left}" y="{top + BASELINE}" fill="{ink}"{weight}>{escape(character)}</text>'


def _rectangle(left: float, top: float, width: float, height: float, fill: str) -> str:
    return f'<rect x="{left}" y="{top}" width="{width}" height="{height}" fill="{fill}"/>'


def _box(ends: str, x: float, y: float, ink: str) -> str:
    ways = {"l": (-WIDTH / 2, 0.0), "r": (WIDTH / 2, 0.0), "u": (0.0, -HEIGHT / 2), "d": (0.0, HEIGHT / 2)}
    width = 3 if ends.isupper() else 1.6
    points = [ways[end] for end in ends.lower()]
    if len(points) == 2:
        (x1, y1), (x2, y2) = points
        way = f"M{x + x1},{y + y1} Q{x},{y} {x + x2},{y + y2}"
    else:
        way = " ".join(f"M{x},{y} L{x + across},{y + down}" for across, down in points)
    return f'<path d="{way}" stroke="{ink}" stroke-width="{width}" fill="none"/>'


def colours(look: Style) -> tuple[str, str]:
    ink = look.color.get_truecolor().hex if look.color is not None else INK
    ground = look.bgcolor.get_truecolor().hex if look.bgcolor is not None else GROUND
    return (ground, ink) if look.reverse else (ink, ground)
