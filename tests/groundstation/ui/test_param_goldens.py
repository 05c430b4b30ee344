"""Frames of all states of the Parameters screen. GOLDEN=write pytest ... writes them anew; then read the diff."""

from __future__ import annotations

import pytest

from groundstation.ui.look.appearance import Look
from tests.groundstation.ui import golden_files
from tests.groundstation.ui.example_params import STATES
from tests.groundstation.ui.pilots import Console, console
from tests.groundstation.ui.test_goldens import SMALL, STANDING, WIDE

SIDE = (190, 45)
FRAMES = {
    **{f"params_{state}_80x24": SMALL for state in STATES},
    **{f"params_{state}_140x45": WIDE for state in ("loading", "lacking", "compare", "pending", "enum")},
    "params_compare_190x45": SIDE,
    "ascii_params_pending_80x24": SMALL,
    "ascii_params_enum_80x24": SMALL,
    "ascii_params_compare_140x45": WIDE,
}


@pytest.mark.parametrize("ascii_only", [False, True])
async def test_the_frames_are_the_golden_ones(ascii_only: bool) -> None:
    names = [name for name in FRAMES if name.startswith("ascii") == ascii_only]
    shown: dict[str, str] = {}
    async with console(FRAMES[names[0]], STANDING, look=Look(ascii=ascii_only)) as screen:
        for name in names:
            await screen.begin_anew(FRAMES[name], STANDING)
            shown[name] = await show_frame(screen, name)
    golden_files.check(shown)


async def show_frame(screen: Console, name: str) -> str:
    views, keys = STATES[name.removeprefix("ascii_").split("_")[1]]
    await screen.press("f4")
    for _ in range(2):
        for view in views:
            screen.station.offer_view(view)
        await screen.show(STANDING)
    await screen.press(*keys)
    await screen.show(STANDING)
    return screen.text


def test_the_frames_fit_their_terminals() -> None:
    golden_files.check_sizes(FRAMES.items())
