"""The command palette."""

from __future__ import annotations

from groundstation.actions import ACTIONS
from groundstation.intents.vehicle import Disarm
from tests.groundstation.ui.examples import snapshot, vehicle
from tests.groundstation.ui.pilots import console
from tests.waits import until

DISARMED = snapshot(vehicle=vehicle(armed=False))


async def test_an_action_of_the_palette_is_done() -> None:
    async with console() as screen:
        await screen.press("ctrl+p")
        await until(lambda: screen.app.screen is not screen.app.drive)
        for letter in "disarm":
            await screen.press(letter)
        await until(lambda: "Disarm" in screen.text)
        await screen.press("enter")
        await until(lambda: screen.station.of(Disarm))


async def test_the_palette_arms_nothing() -> None:
    async with console(picture=DISARMED) as screen:
        titles = [command.title for command in screen.app.get_system_commands(screen.app.screen)]
        assert "Disarm" in titles
        assert not {action.label for action in ACTIONS.values() if action.confirm} & set(titles)
