"""The hint for a key that does nothing on Drive."""

from __future__ import annotations

import pytest

from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.ui.keys.key_hint import SHOWN_FOR, KeyHint

STANDARD = Keymap("standard", KEYMAPS["standard"])


@pytest.mark.parametrize(("key", "mode"), [("3", "AUTO"), ("4", "GUIDED"), ("5", "RTL"), ("6", "LOITER")])
def test_a_digit_says_which_mode_it_is_on_the_map(key: str, mode: str) -> None:
    hint = KeyHint(STANDARD)
    hint.press(key, 1.0)
    assert hint.text(1.0) == f"{key} is {mode} on the Map (F2)"
    assert hint.text(1.0 + SHOWN_FOR) is None


@pytest.mark.parametrize("key", ["1", "2", "i"])
def test_a_bound_key_needs_no_hint(key: str) -> None:
    hint = KeyHint(STANDARD)
    hint.press(key, 1.0)
    assert hint.text(1.0) is None


def test_several_keys_at_once_are_named_until_a_later_key() -> None:
    hint = KeyHint(STANDARD)
    hint.note_burst(1, 1.0)
    hint.press("p", 1.1)
    assert hint.text(1.2) == "several keys at once: ignored"
    hint.note_burst(1, 1.2)
    hint.press("i", 2.0)
    assert hint.text(2.0) is None


def test_the_keys_of_a_copter_are_no_capital_letters_by_mistake() -> None:
    hint = KeyHint(STANDARD)
    hint.press("T", 1.0)
    assert hint.text(1.0) == "T is not bound, t is Clear e-stop: is Caps Lock on?"
    hint.press("T", 2.0, STANDARD.in_flight())
    assert hint.text(2.0) is None
