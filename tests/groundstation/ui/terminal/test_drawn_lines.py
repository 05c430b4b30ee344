"""What is kept in memory of the lines that were drawn on screens."""

from __future__ import annotations

import gc
import weakref

import pytest
from rich.segment import Segment
from textual.strip import Strip

from groundstation.ui.links.screen import LinksScreen
from groundstation.ui.terminal import drawn_lines, interpreter
from tests.groundstation.ui.pilots import console

SCREENS = ("f6", "f7", "question_mark")
"""Keys of screens that cost little to open: Log, Links, Help."""
CHANGES = 8
"""Of these screens and back, after the first."""
SPARE = 60
"""Lines that may differ; a change of the screen draws 145 on average."""


def lines() -> int:
    """Return how many lines exist, whatever refers to them."""
    gc.collect()
    return sum(type(each) is Strip for each in gc.get_objects())


async def test_the_lines_of_a_closed_screen_are_freed() -> None:
    async with console((80, 24)) as screen:
        await screen.press(*SCREENS, "escape")
        drawn = lines()
        for number in range(CHANGES):
            await screen.press(SCREENS[number % len(SCREENS)])
            await screen.press("escape")
        assert lines() < drawn + SPARE, "each change of the screen leaves its lines in memory"


async def test_a_closed_screen_is_freed_when_the_next_one_is_open() -> None:
    thresholds = gc.get_threshold()
    async with console((80, 24)) as screen:
        await screen.press("f7")
        assert isinstance(screen.app.screen, LinksScreen)
        closed = weakref.ref(screen.app.screen)
        await screen.press("escape")
        assert closed() is not None, "its widgets refer to each other"
        try:
            interpreter.freeze()  # what a program with a terminal does when it has started
            gc.unfreeze()
            await screen.press("question_mark")
            assert closed() is None
        finally:
            gc.set_threshold(*thresholds)


@pytest.mark.parametrize(
    ("cuts", "parts"),
    [((5,), ["12345"]), ((2, 5), ["12", "345"]), ((2, 5, 9), ["12", "345"]), ((3,), ["123"]), ((), [])],
)
def test_a_divided_line_is_freed_without_a_collection(cuts: tuple[int, ...], parts: list[str]) -> None:
    drawn_lines.free_with_widget()
    before = lines()
    gc.disable()
    try:
        for _ in range(10):
            line = Strip([Segment("123"), Segment("45")])
            assert [part.text for part in line.divide(iter(cuts))] == parts
        del line
        assert sum(type(each) is Strip for each in gc.get_objects()) == before
    finally:
        gc.enable()
