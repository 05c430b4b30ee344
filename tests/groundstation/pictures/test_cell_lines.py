"""Lines of half blocks, as a terminal shows them."""

from __future__ import annotations

import random

import pytest

from groundstation.pictures.cell_lines import INKS, LEVELS, CellLines, simplify
from groundstation.pictures.picture import Picture
from groundstation.pictures.protocol import Protocol
from tests.groundstation.pictures.decoders import CellScreen

COLUMNS, ROWS = 24, 8
NOISE = Picture(COLUMNS, 2 * ROWS, random.Random(3).randbytes(3 * COLUMNS * 2 * ROWS))


def shown(protocol: Protocol, level: int) -> tuple[Picture, Picture]:
    """The picture that is drawn, and what a terminal shows of it."""
    wanted = simplify(NOISE, COLUMNS, ROWS, level)
    screen = CellScreen()
    for number, line in enumerate(CellLines(INKS[protocol]).draw(wanted)):
        screen.feed(f"\x1b[{number + 1};1H{line}")
    rows = [[screen.pixels(row, column) for column in range(1, COLUMNS + 1)] for row in range(1, ROWS + 1)]
    rgb = bytes(part for row in rows for half in (0, 1) for cell in row for part in cell[half])
    return wanted, Picture(COLUMNS, 2 * ROWS, rgb)


@pytest.mark.parametrize("level", range(len(LEVELS)))
def test_a_terminal_shows_each_level(level: int) -> None:
    wanted, seen = shown(Protocol.BLOCKS, level)
    assert seen == wanted
    square = LEVELS[level].square
    for y in range(2 * ROWS):
        corner = wanted.row(y // square * square)
        for x in range(COLUMNS):
            assert wanted.row(y)[3 * x : 3 * x + 3] == corner[3 * (x // square * square) :][:3]


def test_each_level_is_shorter() -> None:
    wide = Picture(160, 90, random.Random(4).randbytes(3 * 160 * 90))
    sizes = [
        sum(map(len, CellLines(INKS[Protocol.BLOCKS]).draw(simplify(wide, 160, 45, level))))
        for level in range(len(LEVELS))
    ]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[-1] < sizes[0] / 8


def test_fewer_colours_are_near_the_wanted_ones() -> None:
    wanted, seen = shown(Protocol.BLOCKS_256, 0)
    assert max(abs(a - b) for a, b in zip(wanted.rgb, seen.rgb, strict=True)) <= 48


def test_a_line_begins_and_ends_without_colours_of_others() -> None:
    for line in CellLines(INKS[Protocol.BLOCKS]).draw(simplify(NOISE, COLUMNS, ROWS, 0)):
        assert line.startswith("\x1b[48;2;")
        assert line.endswith("\x1b[0m")


OLD, NEW = (1, 2, 3, 4), (1, 2, 5, 6)
"""Rows of two pictures, of which the first line of cells is the same."""


def test_lines_that_stand_still_are_not_drawn_again() -> None:
    lines = CellLines(INKS[Protocol.BLOCKS])
    first, second = (Picture(1, 4, bytes(3 * row + part for row in rows for part in range(3))) for rows in (OLD, NEW))
    before, after = lines.draw(first), lines.draw(second)
    assert after[0] is before[0]
    assert after[1] == CellLines(INKS[Protocol.BLOCKS]).draw(second)[1] != before[1]
