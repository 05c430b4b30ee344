"""Whole frames of the Map screen in each of its states. GOLDEN=write writes them anew; then read the diff."""

from __future__ import annotations

import pytest

from groundstation.snapshot import Snapshot
from groundstation.ui.look.appearance import Look
from tests.groundstation.ui import golden_files
from tests.groundstation.ui.example_map import EDITS, picture, views_for
from tests.groundstation.ui.examples import waiting
from tests.groundstation.ui.pilots import Console, console

SIZES = {"80x24": (80, 24), "140x45": (140, 45), "190x50": (190, 50)}
NO_FIX = picture(gps_fix=2, gps_satellites=5, position=None)

FRAMES: dict[str, tuple[Snapshot, tuple[str, ...]]] = {
    **{f"map_{size}": (picture(), EDITS) for size in ("80x24", "140x45", "190x50")},
    "map_empty_item_80x24": (picture(armed=False, mode="MANUAL", drivable=True), ("tab", "tab")),
    **{f"map_empty_{size}": (picture(armed=False, mode="MANUAL", drivable=True), ()) for size in ("80x24", "140x45")},
    **{f"map_{state}_{size}": (picture(), ()) for state in ("loading", "refused") for size in ("80x24", "140x45")},
    **{f"map_lacking_{size}": (picture(mode="MANUAL", drivable=True), ()) for size in ("80x24", "140x45")},
    **{f"map_nowhere_{size}": (NO_FIX, ()) for size in ("80x24", "140x45")},
    "map_item_80x24": (picture(), ("enter",)),
    "map_question_80x24": (picture(), ("right", "G")),
    **{f"ascii_map_{size}": (picture(), EDITS) for size in ("80x24", "140x45")},
}


def size_of(name: str) -> tuple[int, int]:
    return SIZES[name.rsplit("_")[-1]]


@pytest.mark.parametrize("ascii_only", [False, True])
async def test_the_frames_are_the_golden_ones(ascii_only: bool) -> None:
    names = [name for name in FRAMES if name.startswith("ascii") == ascii_only]
    shown: dict[str, str] = {}
    async with console(size_of(names[0]), FRAMES[names[0]][0], look=Look(ascii=ascii_only)) as screen:
        for name in names:
            await screen.begin_anew(size_of(name), FRAMES[name][0])
            shown[name] = await show_frame(screen, name)
    golden_files.check(shown)


async def show_frame(screen: Console, name: str) -> str:
    shows, keys = FRAMES[name]
    await screen.press("f2")
    for view in views_for(name):
        screen.station.offer_view(view)
    await screen.show(shows)
    await screen.show(shows)  # the size of the map is known after the first one
    for key in ("f", *keys):  # each is painted before the next: a question hides the screen below from painting
        await screen.press(key)
    await screen.show(shows)
    return screen.text


def test_the_frames_fit_their_terminals() -> None:
    golden_files.check_sizes((name, size_of(name)) for name in FRAMES)


async def test_without_a_vehicle_a_file_can_still_be_edited() -> None:
    async with console((80, 24), waiting()) as screen:
        await screen.press("f2", "f")
        assert "no vehicle, and no plan: O opens a file" in screen.text
        await screen.press("U", "G", "P")
        assert "no vehicle yet" in screen.text
