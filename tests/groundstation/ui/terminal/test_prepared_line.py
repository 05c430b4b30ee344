"""A line with its escape sequences ready: as one of segments where something lies over it."""

from __future__ import annotations

import io

from rich.color import Color as RichColor
from rich.console import Console
from rich.segment import Segment
from rich.style import Style
from textual.color import Color
from textual.filter import DimFilter

from groundstation.ui.look.no_colour import NoColourFilter
from groundstation.ui.terminal.prepared_line import PreparedLine

RED = Style(color=RichColor.from_rgb(255, 0, 0))


class Maker:
    """Counts how often the segments are made."""

    def __init__(self) -> None:
        self.made = 0

    def __call__(self) -> list[Segment]:
        self.made += 1
        return [Segment("abcd", RED), Segment("efgh")]


def test_nothing_is_made_of_a_line_that_is_drawn_whole() -> None:
    maker = Maker()
    line = PreparedLine("\x1b[31mabcdefgh\x1b[0m", 8, maker)
    console = Console(file=io.StringIO(), force_terminal=True)
    [whole] = line.adjust_cell_length(8, Style()).divide([8])
    dimmed = whole.apply_filter(DimFilter(), Color(0, 0, 0))
    assert dimmed.render(console) == "\x1b[31mabcdefgh\x1b[0m"
    assert line == PreparedLine("\x1b[31mabcdefgh\x1b[0m", 8, maker)
    assert line != PreparedLine("other", 8, maker)
    assert maker.made == 0


def test_parts_of_a_line_are_those_of_its_segments() -> None:
    maker = Maker()
    line = PreparedLine("ready", 8, maker)
    left, right = line.divide([3, 8])
    assert (left.text, right.text) == ("abc", "defgh")
    assert line.crop(2, 6).text == "cdef"
    assert [each.style for each in line.apply_filter(NoColourFilter(), Color(0, 0, 0))] != [RED, None]
    assert maker.made == 1


def test_the_size_of_a_line_counts_bytes() -> None:
    assert PreparedLine("\x1b[31m▀", 1, Maker()).written == 5 + 3
