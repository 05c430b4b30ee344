"""The command palette."""

from __future__ import annotations

from groundstation.intents import Disarm
from tests.groundstation.ui.pilots import console
from tests.groundstation.ui.ptys import until


async def test_an_action_of_the_palette_is_done() -> None:
    async with console() as screen:
        await screen.press("ctrl+p")
        await until(lambda: screen.app.screen is not screen.app.drive)
        for letter in "disarm":
            await screen.press(letter)
        await until(lambda: "Disarm" in screen.text)
        await screen.press("down", "enter")
        await until(lambda: screen.station.of(Disarm))
