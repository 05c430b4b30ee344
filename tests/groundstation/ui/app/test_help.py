"""The help screen."""

from __future__ import annotations

import pytest

from groundstation.actions import ACTIONS
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.input.pad_mapping import add_buttons, build_mapping
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
        assert "pad D-pad up   Raise both limits" in screen.text
        assert "hold r  pad START    Arm" in screen.text


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
