"""Partial updates of the screen beside what Textual makes of the same changes."""

from __future__ import annotations

import random
from itertools import pairwise
from typing import Any

import msgspec
import pytest
from msgspec.structs import replace
from textual._compositor import ChopsUpdate, Compositor
from textual.geometry import Region
from textual.screen import Screen
from textual.widget import Widget

from groundstation.config.settings import ThemeName
from groundstation.ui.look.appearance import PLAIN, Look
from groundstation.ui.terminal.painting import LineCompositor, find_background
from groundstation.ui.widgets.instrument import Instrument
from tests.groundstation.ui.pilots import Console, console

pytestmark = pytest.mark.usefixtures("painted_at_once")
TRIES = 40


def region(chance: random.Random, width: int, height: int) -> Region:
    x, y = chance.randrange(width), chance.randrange(height)
    return Region(x, y, chance.randint(1, width - x), chance.randint(1, height - y))


def updates(compositor: Compositor, changed: set[Region]) -> tuple[ChopsUpdate, ChopsUpdate]:
    """Return the partial update of our compositor and that of Textual's."""
    found = []
    for kind in (LineCompositor, Compositor):
        compositor._dirty_regions = set(changed)
        update = kind.render_partial_update(compositor)
        assert update is not None
        found.append(update)
    return found[0], found[1]


def compare(screen: Screen[Any], chance: random.Random) -> None:
    for _ in range(TRIES):
        changed = {region(chance, *screen.size) for _ in range(chance.randint(1, 4))}
        ours, stock = updates(screen._compositor, changed)
        assert ours.spans == stock.spans
        assert ours.chop_ends == stock.chop_ends
        for y, start, end in ours.spans:
            cuts = [0, *ours.chop_ends[y]]
            for left, right in pairwise(cuts):
                if left < end and right > start:
                    assert ours.chops[y][left] is not None
                    assert ours.chops[y][left] == stock.chops[y][left], (y, left)


async def check(screen: Console, *keys: str) -> None:
    await screen.press(*keys)
    top = screen.app.screen
    assert isinstance(top._compositor, LineCompositor)
    compare(top, random.Random(5))


async def test_the_changed_lines_are_those_that_textual_would_paint() -> None:
    async with console((140, 45)) as screen:
        await check(screen)
        await check(screen, "f5")
        await check(screen, "escape", "f7")


def compare_lines(screen: Screen[Any]) -> int:
    """Compare all instruments that draw their lines without Textual's styles; return their number."""
    drawn = [each for each in screen.query(Instrument) if each.size and find_background(each) is not None]
    for each in drawn:
        whole = each.size.region
        assert each.render_lines(whole) == Widget.render_lines(each, whole), each
        part = Region(1, 0, whole.width - 1, 1)
        assert each.render_lines(part) == Widget.render_lines(each, part), each
    return len(drawn)


@pytest.mark.parametrize(
    "look", [PLAIN, Look(ascii=True), Look(theme=ThemeName.NO_COLOUR), Look(theme=ThemeName.LIGHT)], ids=str
)
async def test_an_instrument_draws_the_lines_that_textual_would_draw(look: Look) -> None:
    async with console((140, 45), look=look) as screen:
        assert compare_lines(screen.app.screen) > 5
        await screen.press("f7")
        assert compare_lines(screen.app.screen) > 3


async def test_another_theme_changes_the_ground() -> None:
    async with console((140, 45)) as screen:
        screen.app._appearance.choose_theme(ThemeName.LIGHT)
        await screen.pilot.pause()
        assert compare_lines(screen.app.screen) > 5


async def test_a_new_layout_is_followed() -> None:
    async with console((80, 24)) as screen:
        await check(screen)
        await screen.pilot.resize_terminal(140, 45)
        await check(screen)


async def test_nothing_is_painted_where_nothing_has_changed() -> None:
    async with console((80, 24)) as screen:
        compositor = screen.app.screen._compositor
        compositor._dirty_regions = set()
        assert compositor.render_partial_update() is None


async def test_what_a_state_changes_is_painted_in_the_same_call() -> None:
    async with console((140, 45)) as screen:
        shown, before = screen.app.drive, screen.text
        vehicle = shown.snapshot.vehicle
        assert vehicle is not None
        other = msgspec.structs.replace(vehicle, name="Wanderer")
        shown.show_state(replace(shown._state, snapshot=msgspec.structs.replace(shown.snapshot, vehicle=other)))
        assert not any(each._repaint_regions for each in shown.query(Instrument) if each.size)
        assert screen.text != before
        assert "Wanderer" in screen.text
