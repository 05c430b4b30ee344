"""Frames of all states of the Parameters screen. GOLDEN=write pytest ... writes them anew; then read the diff."""

from __future__ import annotations

import os

import pytest

from groundstation.ui.look.appearance import Look
from tests.groundstation.ui.example_params import STATES
from tests.groundstation.ui.pilots import console
from tests.groundstation.ui.test_goldens import GOLDEN, SMALL, STANDING, WIDE

SIDE = (190, 45)
FRAMES = {
    **{f"params_{state}_80x24": SMALL for state in STATES},
    **{f"params_{state}_140x45": WIDE for state in ("loading", "lacking", "compare", "pending", "enum")},
    "params_compare_190x45": SIDE,
    "ascii_params_pending_80x24": SMALL,
    "ascii_params_enum_80x24": SMALL,
    "ascii_params_compare_140x45": WIDE,
}


@pytest.mark.parametrize("name", FRAMES)
async def test_the_frame_is_the_golden_one(name: str) -> None:
    views, keys = STATES[name.removeprefix("ascii_").split("_")[1]]
    async with console(FRAMES[name], STANDING, look=Look(ascii=name.startswith("ascii"))) as screen:
        await screen.press("f4")
        for _ in range(2):
            for view in views:
                screen.station.offer_view(view)
            await screen.show(STANDING)
        await screen.press(*keys)
        await screen.show(STANDING)
        shown = screen.text
    file = GOLDEN / f"{name}.txt"
    if os.environ.get("GOLDEN") == "write":
        file.write_text(shown, "utf-8")
    assert shown == file.read_text("utf-8")
    assert not name.startswith("ascii") or shown.isascii()
    width, height = FRAMES[name]
    assert len(shown.splitlines()) <= height
    assert max(map(len, shown.splitlines())) <= width
