"""Everything can be done without function keys and without a mouse: terminals and keyboards lack either."""

from __future__ import annotations

import itertools
import re

import pytest

from groundstation.actions import ACTIONS, OperatorAction
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.intents.driving import DriveKeyDown
from groundstation.screens import SCREENS
from groundstation.ui.app.navigation import load_screen
from groundstation.ui.app.palette import action_commands
from tests.groundstation.ui.pilots import console
from tests.groundstation.ui.test_goldens import SMALL, STANDING
from tests.rows import each_row
from tests.waits import until

FUNCTION_KEY = re.compile(r"(?:\w+\+)*f\d+")


def plain_keys(keys: tuple[str, ...]) -> list[str]:
    """Return the keys that every keyboard has."""
    return [key for key in keys if not FUNCTION_KEY.fullmatch(key)]


def plain_keys_of(action: str, keymap: Keymap) -> list[str]:
    """Return those of an action, for a rover or for a copter."""
    return plain_keys((*keymap.get_keys(action), *keymap.in_flight().get_keys(action)))


@each_row(("action", "name"), itertools.product(ACTIONS.values(), KEYMAPS))
def test_every_action_has_a_plain_key_or_is_in_a_menu(action: OperatorAction, name: str) -> None:
    keymap = Keymap(name, KEYMAPS[name])
    titles = {command.title.partition("   ")[0] for command in action_commands(keymap, print)}
    menu = {row.action for row in SCREENS if row.digit} | titles
    assert plain_keys_of(action.id, keymap) or {action.id, action.label} & menu


@pytest.mark.parametrize("name", KEYMAPS)
def test_what_the_menus_leave_out_and_what_stops_has_a_plain_key(name: str) -> None:
    """Driving and confirming mean holding a key, which no menu can; a stop must not need one."""
    keymap = Keymap(name, KEYMAPS[name])
    held = [each.id for each in ACTIONS.values() if isinstance(each.intent, DriveKeyDown) or each.confirm]
    assert len(held) == 18
    for action in (*held, "drive.stop", "stop.emergency", "app.goto", "app.quit"):
        assert plain_keys_of(action, keymap), action


@pytest.mark.parametrize("row", SCREENS, ids=lambda row: row.id)
def test_the_keys_of_every_screen_are_plain(row: object) -> None:
    keys = tuple(key.key for key in load_screen(row).KEYS)  # type: ignore[arg-type]
    assert plain_keys(keys) == list(keys)


async def test_every_screen_opens_without_function_keys() -> None:
    async with console(SMALL, STANDING) as screen:
        for row in SCREENS:
            if row.digit:
                await screen.press("ctrl+g", row.digit)
                assert isinstance(screen.app.screen, load_screen(row)), row.id
        await screen.press("ctrl+p", *"help")
        await until(lambda: "Help   ?" in screen.text)
        await screen.press("enter")
        await until(lambda: "keys · Connect first" in screen.text)
