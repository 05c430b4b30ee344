"""Keys that move in a list."""

from __future__ import annotations

import pytest

from groundstation.input.keymap import KEYMAPS
from groundstation.screens import SCREENS
from groundstation.ui.app.navigation import load_screen
from groundstation.ui.base.list_keys import ALL_ROWS, rows_to_move

OWN_LETTERS = ("map", "links")
"""Screens on which g or G is a command."""


@pytest.mark.parametrize(
    ("key", "rows"),
    [
        ("up", -1), ("down", 1), ("ctrl+y", 0), ("pageup", -9), ("ctrl+b", -9), ("pagedown", 9),
        ("ctrl+f", 9), ("ctrl+u", -5), ("ctrl+d", 5), ("home", -ALL_ROWS), ("g", -ALL_ROWS), ("end", ALL_ROWS),
        ("G", ALL_ROWS), ("j", 0), ("k", 0), ("x", 0),
    ],
)  # fmt: skip
def test_keys_move_by_rows_pages_and_to_the_ends(key: str, rows: int) -> None:
    assert rows_to_move(key, 10) == rows


def test_letters_are_left_to_screens_that_use_them() -> None:
    assert [rows_to_move(key, 10, letters=False) for key in ("g", "G", "ctrl+d")] == [0, 0, 5]


def test_no_screen_uses_a_key_of_lists_for_something_else() -> None:
    keys = {"ctrl+b", "ctrl+f", "ctrl+u", "ctrl+d"}
    for row in SCREENS:
        own = {each.key for each in load_screen(row).KEYS}
        assert not own & (keys if row.id in OWN_LETTERS else keys | {"g", "G"}), row.id


@pytest.mark.parametrize("name", KEYMAPS)
def test_no_key_of_lists_stops(name: str) -> None:
    stops = {key for key, action in KEYMAPS[name].items() if action in ("drive.stop", "stop.emergency")}
    assert "k" in stops
    assert not [key for key in stops if rows_to_move(key, 10)]
