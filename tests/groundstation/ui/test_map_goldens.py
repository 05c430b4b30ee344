"""Whole frames of the Map screen in each of its states. GOLDEN=write writes them anew; then read the diff."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from groundstation.snapshot import Snapshot
from groundstation.ui.look.appearance import Look
from tests.groundstation.ui.example_map import EDITS, picture, views_for
from tests.groundstation.ui.examples import waiting
from tests.groundstation.ui.pilots import console

GOLDEN = Path(__file__).parent / "golden"
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


@pytest.mark.parametrize("name", FRAMES)
async def test_the_frame_is_the_golden_one(name: str) -> None:
    shows, keys = FRAMES[name]
    async with console(SIZES[name.rsplit("_")[-1]], shows, look=Look(ascii=name.startswith("ascii"))) as screen:
        await screen.press("f2")
        for view in views_for(name):
            screen.station.offer_view(view)
        await screen.show(shows)
        await screen.show(shows)  # the size of the map is known after the first one
        for key in ("f", *keys):  # each is painted before the next: a question hides the screen below from painting
            await screen.press(key)
        await screen.show(shows)
        shown = screen.text
    file = GOLDEN / f"{name}.txt"
    if os.environ.get("GOLDEN") == "write":
        file.write_text(shown, "utf-8")
    assert shown == file.read_text("utf-8")


@pytest.mark.parametrize("name", FRAMES)
def test_frames_fit_their_terminal(name: str) -> None:
    width, height = SIZES[name.rsplit("_")[-1]]
    text = (GOLDEN / f"{name}.txt").read_text("utf-8")
    assert len(text.splitlines()) <= height
    assert max(map(len, text.splitlines())) <= width
    assert text.isascii() or not name.startswith("ascii")


async def test_without_a_vehicle_a_file_can_still_be_edited() -> None:
    async with console((80, 24), waiting()) as screen:
        await screen.press("f2", "f")
        assert "no vehicle, and no plan: O opens a file" in screen.text
        await screen.press("U", "G", "P")
        assert "no vehicle yet" in screen.text
