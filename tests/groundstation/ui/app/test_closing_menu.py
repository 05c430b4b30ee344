"""Keys that arrive while the go-to menu closes towards another screen."""

from __future__ import annotations

import asyncio

import pytest

from groundstation.intents.plan import ChooseMode
from groundstation.intents.session import SetKeyGate
from groundstation.intents.vehicle import SetMode
from groundstation.ui.app.goto import GoToMenu
from groundstation.ui.links.screen import LinksScreen
from groundstation.ui.log.screen import LogScreen
from tests.groundstation.ui.example_map import pages, picture, plan_view, track
from tests.groundstation.ui.pilots import console, type_in
from tests.waits import PATIENCE, until

ARMED = picture(armed=True, mode="HOLD", speed=0.0)


@pytest.mark.parametrize("below", ["f1", "f2"])
@pytest.mark.parametrize("reads", [("\x0761",), ("\x07", "6", "1")], ids=["one", "three"])
async def test_a_digit_behind_the_choice_of_the_menu_is_no_mode(below: str, reads: tuple[str, ...]) -> None:
    """The digit arrives with the choice, and once more in each turn of the loop until the chosen screen is open."""
    async with console() as screen:
        await screen.press(below)
        for view in (plan_view(), *pages(), track()):
            screen.station.offer_view(view)
        await screen.show(ARMED)
        screen.station.intents.clear()
        for data in reads:
            type_in(screen, data)
            if data == "\x07":
                await screen.pilot.pause()
        async with asyncio.timeout(PATIENCE):
            while not isinstance(screen.app.screen, LogScreen):
                type_in(screen, "1")
                await asyncio.sleep(0)
        assert not [each for each in screen.station.intents if isinstance(each, (SetMode, ChooseMode))]
        assert SetKeyGate(open=True) not in screen.station.intents


@pytest.mark.parametrize("read", ["\x1b[18~", "\x1bOP\x1b[18~", "\x1b[18~1"], ids=["F7", "F1 F7", "F7 1"])
async def test_a_screens_key_while_the_menu_closes_opens_that_screen(read: str) -> None:
    async with console() as screen:
        await screen.show(ARMED)
        screen.station.intents.clear()
        type_in(screen, "\x07")
        await screen.pilot.pause()
        type_in(screen, "6")
        async with asyncio.timeout(PATIENCE):
            while isinstance(screen.app.screen, GoToMenu):  # noqa: ASYNC110, the keys come in the very next turn
                await asyncio.sleep(0)
        type_in(screen, read)
        await until(lambda: isinstance(screen.app.screen, LinksScreen))
        await screen.pilot.pause()
        assert isinstance(screen.app.screen, LinksScreen)
        assert not [each for each in screen.station.intents if isinstance(each, (SetMode, ChooseMode))]
