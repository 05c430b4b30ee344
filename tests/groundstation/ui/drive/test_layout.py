"""The Drive screen at many sizes: what each layout has, and that nothing is cut off or empty."""

from __future__ import annotations

import pytest
from textual.geometry import Region

from groundstation.ui.drive.layout import layout_classes
from groundstation.ui.widgets.instrument import Instrument
from tests.groundstation.ui.examples import MESSAGES_PAGE, SPEEDS, TRACK, snapshot
from tests.groundstation.ui.pilots import Console, console
from tests.groundstation.ui.test_goldens import WARNED

LEAST = {
    "speed": 3, "horizon": 3, "tape": 2, "sticks": 4, "keycaps": 3, "way": 3, "stops": 4, "health": 3, "mission": 1,
    "mission-line": 1, "stops-line": 1, "log": 2, "hint": 1, "footer": 1, "status": 1, "speeds": 3, "links": 2,
}  # fmt: skip
"""Instrument -> rows without which it would lose what a driver needs."""

NARROW = {"mission-line", "stops-line"}
WIDE = {"mission", "way", "stops", "health", "tabs"}


def shown(screen: Console) -> dict[str, Instrument[object]]:
    """Return the instruments that are displayed on the Drive screen, by id."""
    return {each.id or "": each for each in screen.app.drive.query(Instrument) if each.is_on_screen and each.size}


def test_each_size_has_its_layout() -> None:
    assert layout_classes((80, 24)) == {"-narrow"}
    assert layout_classes((119, 40)) == {"-narrow", "-chart"}
    assert layout_classes((120, 29)) == {"-narrow"}, "three columns need 30 rows"
    assert layout_classes((120, 30)) == {"-wide", "-short"}
    assert layout_classes((140, 45)) == {"-wide", "-chart"}
    assert layout_classes((180, 50)) == {"-wide", "-large", "-chart", "-tall"}


@pytest.mark.parametrize(
    "size", [(80, 24), (100, 30), (119, 40), (120, 30), (140, 45), (179, 50), (180, 50), (240, 70)]
)
async def test_nothing_is_cut_off_or_empty(size: tuple[int, int]) -> None:
    """With an alert, too, which takes a row of the log."""
    async with console(size, WARNED) as screen:
        for view in (TRACK, SPEEDS, MESSAGES_PAGE):
            screen.station.offer_view(view)
        await screen.show(WARNED)
        await screen.show(WARNED)
        found = shown(screen)
        wide = size[0] >= 120
        assert (WIDE if wide else NARROW) <= found.keys()
        assert not (NARROW if wide else WIDE) & found.keys()
        assert {"pane-track", "sticks", "keycaps", "log", "alert", "hint", "footer"} <= found.keys()
        assert ("pane2-messages" in found) == (size[0] >= 180)
        whole = Region(0, 0, *size)
        for name, each in found.items():
            assert whole.contains_region(each.region), f"{name} is cut off: {each.region}"
            assert each.size.height >= LEAST.get(name, 1), f"{name} has {each.size.height} rows"
        covered = sum(each.region.area for each in found.values())
        assert covered > 0.75 * whole.area, f"{1 - covered / whole.area:.0%} of the screen is border or empty"


async def test_from_one_size_to_another_and_back() -> None:
    async with console((240, 70)) as screen:
        for size in ((80, 24), (60, 15), (180, 50), (140, 45), (80, 24)):
            await screen.pilot.resize_terminal(*size)
            await screen.show(snapshot())
            found = shown(screen)
            assert ("stops" in found) == (size[0] >= 120)
            assert ("stops-line" in found) == (size == (80, 24))
