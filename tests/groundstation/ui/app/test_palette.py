"""The command palette."""

from __future__ import annotations

import pytest
from textual.command import CommandPalette

from groundstation.actions import ACTIONS
from groundstation.intents.line import RunLine
from groundstation.intents.vehicle import Disarm
from groundstation.intents.watch import Watch
from groundstation.ui.app.command_line import CommandLine
from groundstation.ui.app.palette import LINES, MODES_TEXT, rank
from groundstation.verbs.table import VERBS
from groundstation.views.line import RUNNING, LineRequest, LineView
from tests.groundstation.ui.examples import snapshot, vehicle
from tests.groundstation.ui.pilots import Console, console
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
        assert any(title.startswith("Disarm") for title in titles)
        assert not {action.label for action in ACTIONS.values() if action.confirm} & {
            title.partition("   ")[0] for title in titles
        }


async def search(screen: Console, text: str) -> list[str]:
    """Return the titles that a text finds, the best first."""
    commands = screen.app.get_system_commands(screen.app.screen)
    found = sorted(((rank(text, each), each.title) for each in commands), key=lambda each: -each[0])
    return [title for score, title in found if score > 0]


async def offer_modes(screen: Console) -> None:
    """Let the station name the modes, as it does while the palette is open."""
    screen.station.offer_view(LineView(0, RUNNING, "", MODES_TEXT, ("MANUAL", "HOLD", "AUTO", "GUIDED", "RTL")))
    await screen.show(snapshot())


@pytest.mark.parametrize(
    ("text", "first"),
    [("rtl", "Mode RTL   :mode RTL"), ("auto", "Mode AUTO   :mode AUTO"), ("home", ":home"),
     ("fence off", ":fence off"),
     ("hold", "HOLD   2"), ("emergency", "EMERGENCY STOP   !  F9")],
)  # fmt: skip
async def test_modes_and_verbs_are_found_by_their_words(text: str, first: str) -> None:
    async with console() as screen:
        await offer_modes(screen)
        found = await search(screen, text)
        assert first in found[:2]


async def test_letters_are_not_looked_for_one_by_one() -> None:
    async with console() as screen:
        await offer_modes(screen)
        assert not [title for title in await search(screen, "rtl") if title.startswith(("Release", "Throttle"))]
        assert await search(screen, "qqz") == []


async def test_the_palette_asks_the_station_for_the_modes() -> None:
    async with console() as screen:
        await screen.press("ctrl+p")
        await until(lambda: LineRequest(0, MODES_TEXT, 1) in screen.station.of(Watch)[-1].requests)


async def test_actions_stand_beside_their_keys() -> None:
    async with console() as screen:
        titles = [each.title for each in screen.app.get_system_commands(screen.app.screen)]
        assert {"Release control   G", "Style   ^y", "Map   F2"} <= set(titles)


async def test_what_disarms_is_there_once_and_beside_its_key() -> None:
    for picture in (snapshot(), DISARMED):
        async with console(picture=picture) as screen:
            titles = [each.title for each in screen.app.get_system_commands(screen.app.screen)]
            assert [title for title in titles if title.lower().startswith("disarm")] == ["Disarm   r"]
            assert len(titles) == len(set(titles)), "no two rows look the same"


async def test_a_mode_of_the_palette_is_written_on_the_line_first() -> None:
    async with console() as screen:
        await offer_modes(screen)
        await screen.press("ctrl+p")
        await until(lambda: isinstance(screen.app.screen, CommandPalette))
        await screen.press(*"rtl")
        await until(lambda: "Mode RTL" in screen.text)
        await screen.press("enter")
        await until(lambda: isinstance(screen.app.screen, CommandLine))
        assert not screen.station.of(RunLine)
        await screen.press("enter")
        await until(lambda: screen.station.of(RunLine))
        assert screen.station.of(RunLine)[0].text == "mode RTL"
        assert not screen.station.of(RunLine)[0].confirmed


def test_the_palette_has_every_verb_that_a_line_runs() -> None:
    actions = ((f"{verb} {name}".strip(), each) for verb, row in VERBS.items() for name, each in row.actions.items())
    runnable = {name for name, action in actions if not action.line.elsewhere} - {"mode"}
    assert set(LINES) == runnable
