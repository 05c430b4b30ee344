"""The table of screens: its rows become actions with default keys."""

from __future__ import annotations

import pytest

from groundstation.actions import ACTIONS
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.input.keymap_file import parse_keymap
from groundstation.screens import SCREENS, ScreenRow


@pytest.mark.parametrize("row", SCREENS, ids=lambda row: row.id)
@pytest.mark.parametrize("name", list(KEYMAPS))
def test_each_row_is_an_action_with_its_keys_in_every_map(row: ScreenRow, name: str) -> None:
    action = ACTIONS[row.action]
    assert (action.label, action.help, action.intent) == (row.title, row.help, None)
    assert Keymap(name, KEYMAPS[name]).get_keys(row.action) == row.keys


def test_ids_and_keys_are_unique() -> None:
    assert len({row.id for row in SCREENS}) == len(SCREENS)
    assert len({key for row in SCREENS for key in row.keys}) == sum(len(row.keys) for row in SCREENS)


def test_the_key_of_a_screen_can_be_bound_anew() -> None:
    keymap = parse_keymap({"keys": {"app.help": ["h"]}}, "mine", "mine.toml")
    assert keymap.get_keys("app.help") == ("h",)
