"""The help screen."""

from __future__ import annotations

import pytest

from groundstation.actions import ACTIONS
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.input.pad_mapping import add_buttons, build_mapping
from groundstation.intents.driving import Stop
from groundstation.ui.charts.screen import ChartsScreen
from groundstation.ui.log.screen import LogScreen
from tests.groundstation.ui.pilots import console, helps, helps_pushed, type_in
from tests.waits import until


async def test_help_shows_every_key_and_goes_back() -> None:
    async with console(size=(100, 50)) as screen:
        await screen.press("question_mark")
        assert type(screen.app.screen).__name__ == "HelpScreen"
        assert "Motors off and locked" in screen.text
        await screen.press("escape")
        await until(lambda: screen.app.gate.closure is None)
        assert screen.app.screen is screen.app.drive


async def test_the_buttons_of_a_gamepad_stand_clear_of_the_text(monkeypatch: pytest.MonkeyPatch) -> None:
    with_pad = add_buttons(Keymap("pad", KEYMAPS["standard"]), build_mapping({}))
    monkeypatch.setitem(KEYMAPS, "pad", with_pad.bindings)
    async with console(size=(120, 60), keymap="pad") as screen:
        await screen.press("question_mark")
        assert "pad D-pad up  Raise the speed and turn limits" in screen.text
        assert "hold r  pad START  Arm" in screen.text


async def test_several_keys_of_one_read_open_one_help_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    async with console() as screen:
        depths = helps_pushed(screen, monkeypatch)
        type_in(screen, "???")
        await until(lambda: depths)
        await screen.pilot.pause()
        assert set(depths) == {1}


async def test_the_palette_opens_no_second_help_screen() -> None:
    async with console() as screen:
        await screen.press("question_mark")
        screen.app.choose_action(ACTIONS["app.help"])
        await screen.pilot.pause()
        assert helps(screen) == 1


@pytest.mark.parametrize(("key", "first"), [("f5", "Charts screen"), ("f2", "Map screen"), ("f1", "Drive")])
async def test_help_begins_with_the_keys_of_the_screen_it_covers(key: str, first: str) -> None:
    async with console() as screen:
        await screen.press(key, "question_mark")
        lines = [line.strip("│ \n") for line in screen.text.splitlines()]
        assert next(line for line in lines[1:] if line) == first


async def test_help_returns_to_the_screen_it_was_asked_on() -> None:
    async with console() as screen:
        await screen.press("f5", "question_mark", "q")
        await until(lambda: isinstance(screen.app.screen, ChartsScreen))


@pytest.mark.parametrize(("width", "columns"), [(80, 1), (140, 2), (200, 3)])
async def test_help_uses_the_width_of_the_terminal(width: int, columns: int) -> None:
    async with console(size=(width, 50)) as screen:
        await screen.press("f6", "question_mark")
        below = screen.text.splitlines()[2]
        assert sum(key.help[:20] in below for key in LogScreen.KEYS) == columns


async def test_slash_filters_the_keys_and_escape_shows_all() -> None:
    async with console(size=(100, 40)) as screen:
        await screen.press("f6", "question_mark", "slash", *"zoom out")
        assert "Zoom out of the pane" in screen.text
        assert "Motors off and locked" not in screen.text
        await screen.press("escape")
        assert "Motors off and locked" in screen.text


async def test_letters_of_the_search_are_no_stop_keys() -> None:
    async with console(size=(100, 40)) as screen:
        await screen.press("question_mark", "slash")
        sent = len(screen.station.of(Stop))
        await screen.press("k", "space", "9", "9")
        assert len(screen.station.of(Stop)) == sent
        assert "no key with “k 99”" in screen.text
