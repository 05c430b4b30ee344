"""Pictures of half blocks: a cell shows two pixels, one above the other. Only cells that have changed are drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import lru_cache

from groundstation.pictures.picture import Picture

HALF_BLOCK = "▀"
RESET = "\x1b[0m"
RAMP = " .:-=+*#%@"
"""From black to white, for ASCII."""

Ink = Callable[[bytes, bool], str]
"""Return the parameters of SGR for a pixel, as the colour of text or, if True, of the ground."""

CACHED_COLOURS = 1 << 15


class CellEncoder:
    """Draws pictures of as many pixels as the area has columns, and twice as many as it has rows."""

    def __init__(self, ink: Ink) -> None:
        self._ink = ink
        self._shown: list[list[bytes]] = []

    def forget(self) -> None:
        """Draw all cells the next time: the terminal was cleared."""
        self._shown = []

    def encode(self, picture: Picture, row: int, column: int) -> str:
        """Return what draws a picture whose first cell is there, counted from 1."""
        rows = [_cells(picture, y) for y in range(0, picture.height - 1, 2)]
        known = self._shown if [*map(len, self._shown)] == [*map(len, rows)] else [[b""] * len(each) for each in rows]
        self._shown = rows
        parts = list[str]()
        pen = (b"", b"")
        for number, (cells, before) in enumerate(zip(rows, known, strict=True)):
            if cells != before:
                pen = self._draw_row(cells, before, f"\x1b[{row + number};", column, pen, parts)
        return "".join([*parts, RESET]) if parts else ""

    def _draw_row(
        self,
        cells: list[bytes],
        before: list[bytes],
        move: str,
        column: int,
        pen: tuple[bytes, bytes],
        parts: list[str],
    ) -> tuple[bytes, bytes]:
        """Add the changed cells of a row to `parts`; `pen`: the colours that are set. Return those at the end."""
        text, ground = pen
        ink, drawn = self._ink, -1
        for at, cell in enumerate(cells):
            if cell == before[at]:
                continue
            if drawn != at - 1 or not at:
                parts.append(f"{move}{column + at}H")
            drawn, upper, lower = at, cell[:3], cell[3:]
            if lower != ground:
                parts.append(f"\x1b[{ink(lower, True)}m")
                ground = lower
            if upper == lower:
                parts.append(" ")
                continue
            if upper != text:
                parts.append(f"\x1b[{ink(upper, False)}m")
                text = upper
            parts.append(HALF_BLOCK)
        return text, ground


class AsciiEncoder:
    """Draws pictures of the same size with characters, by their brightness. A row that has changed is drawn whole."""

    def __init__(self) -> None:
        self._shown: list[str] = []

    def forget(self) -> None:
        """Draw all rows the next time."""
        self._shown = []

    def encode(self, picture: Picture, row: int, column: int) -> str:
        """Return what draws a picture whose first cell is there, counted from 1."""
        light, width = picture.brightness(), picture.width
        lines = [
            "".join(_MARKS[upper + lower] for upper, lower in zip(*_two_rows(light, y, width), strict=True))
            for y in range(0, picture.height - 1, 2)
        ]
        known = self._shown if len(self._shown) == len(lines) else [""] * len(lines)
        self._shown = lines
        return "".join(
            f"\x1b[{row + number};{column}H{line}"
            for number, (line, before) in enumerate(zip(lines, known, strict=True))
            if line != before
        )


_MARKS = [RAMP[total * len(RAMP) // 511] for total in range(511)]


def _two_rows(light: bytes, y: int, width: int) -> Iterator[bytes]:
    yield from (light[number * width : (number + 1) * width] for number in (y, y + 1))


def _cells(picture: Picture, y: int) -> list[bytes]:
    """Return the 6 bytes of each cell whose upper pixels are row y."""
    upper, lower = picture.row(y), picture.row(y + 1)
    return [upper[at : at + 3] + lower[at : at + 3] for at in range(0, len(upper), 3)]


@lru_cache(CACHED_COLOURS)
def true_colour(pixel: bytes, ground: bool) -> str:
    """Return SGR 38;2 or 48;2."""
    red, green, blue = pixel
    return f"{48 if ground else 38};2;{red};{green};{blue}"


@lru_cache(CACHED_COLOURS)
def colour_256(pixel: bytes, ground: bool) -> str:
    """Return SGR 38;5 or 48;5: the nearest of the cube and of the greys of xterm."""
    steps = pixel.translate(_NEAREST_STEP)
    shade = min(23, max(0, (sum(pixel) // 3 - 3) // 10))
    of_cube = sum((_STEPS[step] - part) ** 2 for step, part in zip(steps, pixel, strict=True))
    of_greys = sum((8 + 10 * shade - part) ** 2 for part in pixel)
    number = 232 + shade if of_greys < of_cube else 16 + 36 * steps[0] + 6 * steps[1] + steps[2]
    return f"{48 if ground else 38};5;{number}"


@lru_cache(CACHED_COLOURS)
def colour_16(pixel: bytes, ground: bool) -> str:
    """Return SGR 30 to 37 and 90 to 97, or those of the ground."""
    number = _nearest_of_16(pixel.translate(_ROUGH))
    return str((number if number < 8 else number + 52) + (40 if ground else 30))


_STEPS = (0, 95, 135, 175, 215, 255)
"""Levels of a channel in the cube of 6 x 6 x 6 colours of xterm."""
_NEAREST_STEP = bytes(min(range(6), key=lambda step: abs(_STEPS[step] - value)) for value in range(256))
_ROUGH = bytes(value // 16 * 17 for value in range(256))
"""16 levels: few enough pixels that each is looked up once."""
_TABLE_16 = [tuple((number >> bit & 1) * (255 if number > 7 else 170) for bit in range(3)) for number in range(16)]
_TABLE_16[7:9] = [(170, 170, 170), (85, 85, 85)]
"""Colours as most terminals have them; users choose their own."""


@lru_cache(16**3)
def _nearest_of_16(pixel: bytes) -> int:
    return min(range(16), key=lambda number: sum((a - b) ** 2 for a, b in zip(pixel, _TABLE_16[number], strict=True)))
